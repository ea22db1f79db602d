import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api, body } from "../../api/client";
import { Confirm } from "../../components/Confirm";
import { useScope } from "../../shell/session";
import { type Minimization, mayBeCancelled } from "./minimization";

/** Cancels a minimisation that has not ended, after a question. */
export function CancelMinimization({ minimization }: { readonly minimization: Minimization }) {
  const { id } = minimization;
  const queries = useQueryClient();
  const { maySubmit } = useScope();
  const [asking, setAsking] = useState(false);
  const cancel = useMutation({
    mutationFn: async () =>
      body(
        await api.POST("/api/v1/minimizations/{minimization_id}:cancel", {
          params: { path: { minimization_id: id } },
        }),
      ),
    onSuccess: (cancelled) => queries.setQueryData(["minimization", id], cancelled),
  });
  return (
    <>
      {cancel.isError && (
        <span role="alert" className="refusal">
          {cancel.error.message}
        </span>
      )}
      {maySubmit && mayBeCancelled(minimization) && (
        <button type="button" disabled={cancel.isPending} onClick={() => setAsking(true)}>
          Cancel
        </button>
      )}
      {asking && (
        <Confirm
          title="Cancel this minimisation?"
          action="Cancel the minimisation"
          onYes={() => cancel.mutate()}
          onClose={() => setAsking(false)}
        >
          It cannot be resumed afterwards. The smallest scenario so far stays.
        </Confirm>
      )}
    </>
  );
}
