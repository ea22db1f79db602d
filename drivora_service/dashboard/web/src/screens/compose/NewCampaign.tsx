import { useSearch } from "@tanstack/react-router";
import { useTitle } from "../../shell/useTitle";
import { AgentSection } from "./AgentSection";
import { Compose } from "./Compose";
import { Start } from "./Start";
import { postCampaign, validateCampaign } from "./starting";
import { TesterSection } from "./TesterSection";

/** Composes a campaign and starts it. */
export function NewCampaign() {
  useTitle("New campaign");
  const search = useSearch({ from: "/campaigns/new" });
  return (
    <Compose
      kind="campaign"
      title="New campaign"
      search={search}
      validate={validateCampaign}
      who={(form) => (
        <>
          <AgentSection form={form} />
          <TesterSection form={form} />
        </>
      )}
      outcome={({ counted, draft, document }, validation) => (
        <Start
          kind="campaign"
          counted={counted}
          draft={draft}
          document={document}
          validation={validation}
          post={postCampaign}
          ready={({ genes }) => `Ready: ${genes} genes describe a candidate`}
        />
      )}
    />
  );
}
