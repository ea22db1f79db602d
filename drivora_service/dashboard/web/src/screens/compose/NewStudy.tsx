import { useSearch } from "@tanstack/react-router";
import { count } from "../../components/numbers";
import { useTitle } from "../../shell/useTitle";
import { AgentsSection } from "./AgentSection";
import { Compose } from "./Compose";
import { Start } from "./Start";
import { postStudy, validateStudy } from "./starting";
import { MethodsSection } from "./TesterSection";

/** Composes a study and starts it. */
export function NewStudy() {
  useTitle("New study");
  const search = useSearch({ from: "/studies/new" });
  return (
    <Compose
      kind="study"
      title="New study"
      search={search}
      validate={validateStudy}
      who={(form) => (
        <>
          <AgentsSection form={form} />
          <MethodsSection form={form} />
        </>
      )}
      outcome={({ counted, draft, document }, validation) => (
        <Start
          kind="study"
          counted={counted}
          draft={draft}
          document={document}
          validation={validation}
          post={postStudy}
          ready={({ campaigns, simulations }) =>
            `Ready: ${count(campaigns)} ${campaigns === 1 ? "campaign" : "campaigns"}, ` +
            `${count(simulations)} simulations`
          }
        />
      )}
    />
  );
}
