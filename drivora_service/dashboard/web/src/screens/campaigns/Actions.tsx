import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api, type Schemas } from "../../api/client";
import { Confirm } from "../../components/Confirm";
import { useScope } from "../../shell/session";
import { type Action, actionsOf } from "./state";

type Kind = "campaign" | "study";

const WORDS = { pause: "Pause", resume: "Resume", cancel: "Cancel" } as const;

async function ask(kind: Kind, id: string, action: Action): Promise<void> {
  if (kind === "campaign") {
    const params = { path: { campaign_id: id } };
    if (action === "pause") await api.POST("/api/v1/campaigns/{campaign_id}:pause", { params });
    if (action === "resume") await api.POST("/api/v1/campaigns/{campaign_id}:resume", { params });
    if (action === "cancel") await api.POST("/api/v1/campaigns/{campaign_id}:cancel", { params });
    return;
  }
  const params = { path: { study_id: id } };
  if (action === "pause") await api.POST("/api/v1/studies/{study_id}:pause", { params });
  if (action === "resume") await api.POST("/api/v1/studies/{study_id}:resume", { params });
  if (action === "cancel") await api.POST("/api/v1/studies/{study_id}:cancel", { params });
}

/** Pauses, resumes and cancels a campaign or a study; asks before cancelling. */
export function Actions({
  kind,
  id,
  name,
  state,
  request,
  small = false,
}: {
  readonly kind: Kind;
  readonly id: string;
  readonly name: string;
  readonly state: Schemas["CampaignState"] | Schemas["StudyState"];
  readonly request: Schemas["CampaignRequest"];
  readonly small?: boolean;
}) {
  const queries = useQueryClient();
  const [asking, setAsking] = useState(false);
  const { maySubmit } = useScope();
  const doing = useMutation({
    mutationFn: (action: Action) => ask(kind, id, action),
    onSettled: () =>
      queries.invalidateQueries({
        predicate: ({ queryKey: [of, which] }) => of === kind && (which === id || which === "list"),
      }),
  });
  return (
    <span className={small ? "doing small" : "doing"}>
      {(maySubmit ? actionsOf(state, request) : []).map((action) => (
        <button
          key={action}
          type="button"
          disabled={doing.isPending}
          aria-label={`${WORDS[action]} ${name}`}
          onClick={() => (action === "cancel" ? setAsking(true) : doing.mutate(action))}
        >
          {WORDS[action]}
        </button>
      ))}
      {doing.isError && (
        <span className="refusal" role="alert" title={doing.error.message}>
          {doing.error.message}
        </span>
      )}
      {asking && (
        <Confirm
          title={`Cancel ${name}?`}
          action={`Cancel the ${kind}`}
          onYes={() => doing.mutate("cancel")}
          onClose={() => setAsking(false)}
        >
          It cannot be resumed afterwards. What it has found stays.
        </Confirm>
      )}
    </span>
  );
}
