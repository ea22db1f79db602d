import { useNavigate, useSearch } from "@tanstack/react-router";
import { firstOf } from "../../address";
import { api, body, type Schemas } from "../../api/client";
import { type Column, DataTable } from "../../components/DataTable";
import { Filters } from "../../components/Filters";
import { Mark, type MarkLook } from "../../components/Mark";
import { fixed, moment } from "../../components/numbers";
import { Empty, Loading, Refused } from "../../components/States";
import { useList } from "../../lists/useList";
import { ACCOUNTABILITY, kindText, plain } from "../failures/words";

type Row = Schemas["EvaluationSummary"];

const STATUSES = ["judged", "invalid", "failed"] as const;
const FILTERS = [
  { name: "status", title: "Status", values: STATUSES, single: true },
  {
    name: "violating",
    title: "Failures",
    values: ["true", "false"],
    words: { true: "with a failure", false: "without" },
    single: true,
  },
] as const;

/** Candidates without a verdict never look like passed ones. */
function lookOf({ status, violations, accountability }: Row): MarkLook {
  if (status === "invalid") return { sign: "⊘", tone: "lost", text: "invalid" };
  if (status === "failed") return { sign: "⚠", tone: "lost", text: "no result" };
  // Its run may violate oracles that the campaign does not count.
  if (violations === 0) return { sign: "✓", tone: "good", text: "none that counts" };
  return accountability
    ? ACCOUNTABILITY[accountability]
    : { sign: "✕", tone: "lost", text: "failure" };
}

function columnsOf(objectives: readonly string[]): readonly Column<Row>[] {
  return [
    { id: "number", title: "Number", width: "74px", numeric: true, cell: ({ number }) => number },
    { id: "result", title: "Result", width: "190px", cell: (row) => <Mark {...lookOf(row)} /> },
    {
      id: "kinds",
      title: "Failures",
      width: "minmax(220px, 1fr)",
      cell: ({ failure_kinds, cause }) => failure_kinds.map(kindText).join("; ") || cause,
    },
    {
      id: "generation",
      title: "Generation",
      width: "88px",
      numeric: true,
      cell: ({ generation }) => generation,
    },
    { id: "origin", title: "Made by", width: "110px", cell: ({ origin }) => origin },
    ...objectives.map(
      (name): Column<Row> => ({
        id: `objective ${name}`,
        title: plain(name),
        width: "130px",
        numeric: true,
        hint: `Objective ${name}, to be minimised`,
        cell: ({ objectives, status }) =>
          fixed(objectives[name], 3) ||
          (status === "judged" ? <span className="quiet">not measurable</span> : ""),
      }),
    ),
    {
      id: "sim_time_s",
      title: "Simulated (s)",
      width: "98px",
      numeric: true,
      cell: ({ sim_time_s }) => fixed(sim_time_s, 1),
    },
    { id: "told_at", title: "Told at", width: "150px", cell: ({ told_at }) => moment(told_at) },
  ];
}

/** The log of a campaign: its evaluations, newest first. */
export function Evaluations({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const search = useSearch({ from: "/campaigns/$id" });
  const navigate = useNavigate();
  const status = STATUSES.find((value) => value === firstOf(search, "status"));
  const violating = firstOf(search, "violating");
  const filters = {
    ...(status ? { status } : {}),
    ...(violating ? { violating: violating === "true" } : {}),
  };
  const { query, rows, more } = useList<Row>(
    ["campaign", campaign.id, "evaluations", filters],
    async (page_token) =>
      body(
        await api.GET("/api/v1/campaigns/{campaign_id}/evaluations", {
          params: {
            path: { campaign_id: campaign.id },
            query: {
              order: "-number",
              limit: 200,
              ...filters,
              ...(page_token ? { page_token } : {}),
            },
          },
        }),
      ),
  );
  return (
    <>
      <Filters filters={FILTERS} search={search} />
      {query.isPending ? (
        <Loading />
      ) : query.isError ? (
        <Refused error={query.error} />
      ) : rows.length === 0 ? (
        <Empty title="No evaluation matches">
          <p>{campaign.counts.evaluations} candidates are evaluated so far.</p>
        </Empty>
      ) : (
        <DataTable
          label="Evaluations"
          columns={columnsOf(Object.keys(campaign.best ?? {}))}
          rows={rows}
          idOf={({ number }) => String(number)}
          onOpen={({ number }) =>
            void navigate({
              to: ".",
              search: { tab: "ancestry", number: String(number) },
              resetScroll: false,
            })
          }
          onEnd={more}
        />
      )}
    </>
  );
}
