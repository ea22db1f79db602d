import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api } from "../../api/client";
import { Confirm } from "../../components/Confirm";
import { count } from "../../components/numbers";
import { useScope } from "../../shell/session";
import { actionsOf, type Batch, type BatchAction, standingOf } from "./batch";

const WORDS: Readonly<Record<BatchAction, string>> = {
  pause: "Pause",
  resume: "Resume",
  cancel: "Cancel",
};

async function ask(batch: Batch, action: BatchAction): Promise<unknown> {
  const params = { params: { path: { batch_id: batch.id } } };
  if (action === "pause") return api.POST("/api/v1/batches/{batch_id}:pause", params);
  if (action === "resume") return api.POST("/api/v1/batches/{batch_id}:resume", params);
  return api.POST("/api/v1/batches/{batch_id}:cancel", params);
}

/** What can be done with a batch now; a refusal is told beside the buttons. */
export function BatchActions({ batch }: { readonly batch: Batch }) {
  const queries = useQueryClient();
  const [asking, setAsking] = useState(false);
  const action = useMutation({
    mutationFn: (what: BatchAction) => ask(batch, what),
    onSettled: () =>
      queries.invalidateQueries({
        predicate: ({ queryKey: [kind, id] }) =>
          kind === "batch" && (id === batch.id || id === "list"),
      }),
  });
  const { maySubmit } = useScope();
  const { waiting, running } = standingOf(batch);
  return (
    <>
      {action.isError && (
        <span role="alert" className="refusal">
          {action.error.message}
        </span>
      )}
      {(maySubmit ? actionsOf(batch) : []).map((what) => (
        <button
          key={what}
          type="button"
          disabled={action.isPending}
          onClick={() => (what === "cancel" ? setAsking(true) : action.mutate(what))}
        >
          {WORDS[what]}
        </button>
      ))}
      {asking && (
        <Confirm
          title={`Cancel ${batch.name || "this batch"}?`}
          action="Cancel the batch"
          onYes={() => action.mutate("cancel")}
          onClose={() => setAsking(false)}
        >
          {count(waiting)} waiting and {count(running)} running runs end without a result. A
          cancelled batch cannot be resumed.
        </Confirm>
      )}
    </>
  );
}
