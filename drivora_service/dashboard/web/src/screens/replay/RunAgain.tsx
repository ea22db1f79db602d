import { useMutation } from "@tanstack/react-query";
import { useNavigate } from "@tanstack/react-router";
import { api, body } from "../../api/client";
import { useScope } from "../../shell/session";
import { repeatLabel } from "./compareChoices";

/** Queues the scenario of a run again, with its agents and seed, and opens the new run. */
export function RunAgain({
  id,
  isMain = false,
}: {
  readonly id: string;
  /** Whether it is what a reader of the screen most likely wants. */
  readonly isMain?: boolean;
}) {
  const { maySubmit } = useScope();
  const navigate = useNavigate();
  const again = useMutation({
    mutationFn: async () => {
      // Agents and seed that were set beside the document are in it.
      const scenario = body(
        await api.GET("/api/v1/runs/{run_id}/scenario", { params: { path: { run_id: id } } }),
      );
      return body(
        await api.POST("/api/v1/jobs", {
          params: { query: { label: repeatLabel(id) } },
          body: scenario,
        }),
      );
    },
    onSuccess: (job) => navigate({ to: "/runs/$runId", params: { runId: job.id }, search: {} }),
  });
  if (!maySubmit)
    return (
      <span className="quiet">To run it again here, sign in with a token that may submit.</span>
    );
  return (
    <>
      <button
        type="button"
        className={isMain ? "primary" : undefined}
        disabled={again.isPending}
        title="Run the same scenario again, record it, and open the new run"
        onClick={() => again.mutate()}
      >
        Run it again here
      </button>
      {again.isError && (
        <span role="alert" className="refusal">
          {again.error.message}
        </span>
      )}
    </>
  );
}
