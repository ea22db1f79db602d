import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { api, body, type Schemas } from "../../api/client";
import { Mark } from "../../components/Mark";
import { Picture } from "../../components/Picture";
import { addressOf } from "../../service";
import { leftWords, lookOfMinimization } from "../minimizations/minimization";

/** The smallest scenario that fails in the same way, beside the failure; the newest, if any. */
export function MinimisedForm({ failure }: { readonly failure: Schemas["FoundFailure"] }) {
  const { run_id, oracle } = failure;
  // The run of a campaign, and the one that confirmed it.
  const runs = failure.campaign_id ? [run_id, `${run_id}-again`] : [run_id];
  const { data } = useQuery({
    queryKey: ["minimization", "list", runs],
    queryFn: async () => {
      const answers = await Promise.all(
        runs.map((run) => api.GET("/api/v1/minimizations", { params: { query: { run } } })),
      );
      return answers.flatMap((answer) => body(answer).items);
    },
  });
  const newest = data?.find((one) => one.failure.oracle === oracle);
  if (!newest) return null;
  const minimal = newest.minimal_run_id;
  return (
    <div className="minimised">
      <h3>
        <Link to="/minimizations/$id" params={{ id: newest.id }}>
          Minimised
        </Link>{" "}
        <Mark {...lookOfMinimization(newest)} />
      </h3>
      {minimal && (
        <Picture
          src={addressOf(`/api/v1/runs/${minimal}/picture`)}
          alt={`Moments of the smallest scenario that fails like: ${failure.sentence}`}
        />
      )}
      <p className="quiet">{leftWords(newest)}</p>
    </div>
  );
}
