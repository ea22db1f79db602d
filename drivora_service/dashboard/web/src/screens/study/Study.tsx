import { useQuery } from "@tanstack/react-query";
import { useNavigate, useParams, useSearch } from "@tanstack/react-router";
import { firstOf } from "../../address";
import { api, body, type Schemas } from "../../api/client";
import { DataTable } from "../../components/DataTable";
import { Mark } from "../../components/Mark";
import { count } from "../../components/numbers";
import { Progress } from "../../components/Progress";
import { Loading, Refused } from "../../components/States";
import { Warnings } from "../../components/Warnings";
import { addressOf } from "../../service";
import { useTitle } from "../../shell/useTitle";
import { Actions } from "../campaigns/Actions";
import { COLUMNS } from "../campaigns/columns";
import { lookOfSearch } from "../campaigns/state";
import { AgainWith } from "../compose/SearchFrom";
import { useStudyCampaigns } from "./asked";
import { type Cell, cellsOf } from "./cells";
import { Figures } from "./Figures";
import { Matrix } from "./Matrix";
import { StudySettings } from "./StudySettings";

export function Study() {
  const { id } = useParams({ from: "/studies/$id" });
  const query = useQuery({
    queryKey: ["study", id],
    queryFn: async () =>
      body(await api.GET("/api/v1/studies/{study_id}", { params: { path: { study_id: id } } })),
  });
  const campaigns = useStudyCampaigns(id);
  useTitle(query.data?.name ?? "Study");
  if (query.isPending || campaigns.isPending) return <Loading />;
  if (query.isError) return <Refused error={query.error} onRepeat={() => void query.refetch()} />;
  if (campaigns.isError) return <Refused error={campaigns.error} />;
  return <Loaded study={query.data} campaigns={campaigns.data} />;
}

function Loaded({
  study,
  campaigns,
}: {
  readonly study: Schemas["Study"];
  readonly campaigns: readonly Schemas["CampaignSummary"][];
}) {
  const search = useSearch({ from: "/studies/$id" });
  const navigate = useNavigate();
  const cells = cellsOf(campaigns);
  const chosen = firstOf(search, "cell");
  const cell = cells.get(chosen);
  const { id, name, state, request } = study;
  const finished = campaigns.filter((campaign) => campaign.state === "finished").length;
  return (
    <>
      <div className="head">
        <h1>{name || id}</h1>
        <Mark {...lookOfSearch(state, request)} />
        <div className="actions">
          <Tables id={id} />
          <AgainWith kind="study" id={id} />
          <Actions kind="study" id={id} name={name} state={state} request={request} />
        </div>
        <p className="facts">
          <span>
            {finished} of {campaigns.length} campaigns finished
          </span>
          <Progress done={study.simulations} of={study.budget} />
        </p>
      </div>
      <p className="answer">
        {count(study.counts.violating)} of {count(study.simulations)} simulations failed
        {study.counts.avoidable !== null &&
          `; ${count(study.counts.avoidable)} of them count: an ego was at fault, and it was avoidable`}
        .
      </p>
      <Warnings warnings={study.warnings} missing={study.missing_results} />
      <section className="panel">
        <header>
          <h2>Failures that count + others</h2>
          <span className="quiet">Bars: share of the simulations. A cell shows its campaigns.</span>
        </header>
        <Matrix cells={cells} chosen={chosen} search={search} />
      </section>
      {cell && (
        <section className="panel">
          <header>
            <h2>
              {cell.scenario} · {cell.agent} · {cell.method}
            </h2>
          </header>
          <DataTable
            label={`Campaigns of ${cell.scenario}, ${cell.agent}, ${cell.method}`}
            columns={COLUMNS}
            rows={cell.campaigns}
            idOf={(campaign) => campaign.id}
            onOpen={(campaign) =>
              void navigate({ to: "/campaigns/$id", params: { id: campaign.id }, search: {} })
            }
            height="240px"
          />
        </section>
      )}
      <Figures study={study} cells={cells} finished={finished} place={placeOf(search, cells)} />
      <StudySettings document={study.document} />
    </>
  );
}

/** The place of the figures: the chosen one, or that with the most failures that count. */
function placeOf(search: Parameters<typeof firstOf>[0], cells: ReadonlyMap<string, Cell>): string {
  const chosen = firstOf(search, "place");
  if (chosen) return chosen;
  const sums = new Map<string, number>();
  for (const { scenario, agent, avoidable, failing } of cells.values()) {
    const place = JSON.stringify([scenario, agent]);
    sums.set(place, (sums.get(place) ?? 0) + (avoidable ?? 0) + failing / 1e6);
  }
  return [...sums].sort((a, b) => b[1] - a[1])[0]?.[0] ?? "";
}

const TABLES = ["campaigns", "evaluations", "failures"] as const;

/** The numbers into a spreadsheet. */
function Tables({ id }: { readonly id: string }) {
  return (
    <span className="doing">
      CSV:
      {TABLES.map((table) => (
        <a
          key={table}
          href={addressOf(`/api/v1/studies/${id}/tables/${table}`)}
          download={`${table}.csv`}
        >
          {table}
        </a>
      ))}
    </span>
  );
}
