import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { api, body, type Schemas } from "../../api/client";
import { Mark } from "../../components/Mark";
import { Picture, violationQuery } from "../../components/Picture";
import { Loading, Refused } from "../../components/States";
import { addressOf } from "../../service";
import { ACCOUNTABILITY, kindText } from "../failures/words";
import { useEvaluation } from "./evaluation";

const SHOWN = 8;

/** The newest evaluations with failures, as cards. */
export function Newest({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const query = useQuery({
    queryKey: ["campaign", campaign.id, "newest", SHOWN],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/campaigns/{campaign_id}/evaluations", {
          params: {
            path: { campaign_id: campaign.id },
            query: { violating: true, order: "-number", limit: SHOWN },
          },
        }),
      ),
  });
  if (query.isPending) return <Loading rows={4} />;
  if (query.isError) return <Refused error={query.error} />;
  if (query.data.items.length === 0) return <p className="quiet">None that it counts so far.</p>;
  return (
    <ul className="cards">
      {query.data.items.map((evaluation) => (
        <Card key={evaluation.number} campaign={campaign.id} evaluation={evaluation} />
      ))}
    </ul>
  );
}

function Card({
  campaign,
  evaluation,
}: {
  readonly campaign: string;
  readonly evaluation: Schemas["EvaluationSummary"];
}) {
  const { data } = useEvaluation(campaign, evaluation.number);
  const worst = data?.failures[0];
  return (
    <li className="card">
      {worst && data?.observations_url && (
        <Picture
          src={addressOf(
            `/api/v1/campaigns/${campaign}/evaluations/${evaluation.number}/picture${violationQuery(worst)}`,
          )}
          alt={`Moments of evaluation ${evaluation.number}`}
        />
      )}
      <Link
        className="whole"
        to="/campaigns/$id"
        params={{ id: campaign }}
        search={{ tab: "ancestry", number: String(evaluation.number) }}
      >
        {worst?.message ?? kindText(evaluation.failure_kinds[0] ?? "")}
      </Link>
      <span className="facts">
        {evaluation.accountability && <Mark {...ACCOUNTABILITY[evaluation.accountability]} />}
        <span>{kindText(evaluation.failure_kinds[0] ?? "")}</span>
        <span className="quiet">
          evaluation {evaluation.number}
          {worst?.time != null && `, at ${worst.time.toFixed(2)} s`}
          {evaluation.violations > 1 && `, and ${evaluation.violations - 1} more`}
        </span>
      </span>
    </li>
  );
}
