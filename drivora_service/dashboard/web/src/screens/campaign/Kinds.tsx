import { Link, useNavigate, useSearch } from "@tanstack/react-router";
import { firstOf } from "../../address";
import { api, body, type Schemas } from "../../api/client";
import { type Column, DataTable } from "../../components/DataTable";
import { Filters } from "../../components/Filters";
import { Mark } from "../../components/Mark";
import { count, fixed } from "../../components/numbers";
import { Empty, Loading, Refused } from "../../components/States";
import { OracleHelp } from "../../help/OracleHelp";
import { useList } from "../../lists/useList";
import { useDiscoveries } from "../campaigns/discoveries";
import { ACCOUNTABILITIES, kindText, plain, wordsOfKind } from "../failures/words";
import { ACCOUNTABILITY_WORDS } from "../runs/filters";

type Kind = Schemas["FailureKind"];
type Failure = Schemas["Failure"];

/** As many as the service counts at once. */
const MOST_KINDS = 100;

const CONFIRMATIONS = ["open", "confirmed", "flaky"] as const;
const FILTERS = [
  {
    name: "accountability",
    title: "Avoidability",
    values: ACCOUNTABILITIES,
    words: ACCOUNTABILITY_WORDS,
    single: true,
  },
  {
    name: "at_fault",
    title: "At fault",
    values: ["true", "false"],
    words: { true: "an ego at fault", false: "no ego at fault" },
    single: true,
  },
  { name: "confirmation", title: "Second run", values: CONFIRMATIONS, single: true },
  { name: "oracle", title: "Oracle", single: true },
] as const;

/** The failures of a campaign: their kinds, and the violations of those that are chosen. */
export function Kinds({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const search = useSearch({ from: "/campaigns/$id" });
  const chosen = firstOf(search, "kind");
  const { data } = useDiscoveries(campaign.id, 2, MOST_KINDS);
  const firsts = new Map(data?.kinds.map((kind) => [kind.name, kind]));
  if (campaign.kinds.length === 0)
    return (
      <Empty title="No failure that it counts so far">
        <p>
          {campaign.simulations} of {campaign.budget} simulations are judged.
        </p>
      </Empty>
    );
  const kinds: readonly Column<Kind>[] = [
    {
      id: "kind",
      title: "Kind",
      width: "minmax(240px, 1fr)",
      cell: ({ kind }) => (
        <Link
          to="."
          search={{ ...search, kind: kind === chosen ? "" : kind }}
          resetScroll={false}
          aria-current={kind === chosen}
        >
          {kindText(kind)}
        </Link>
      ),
    },
    counted("failures", "Simulations", ({ failures }) => failures, {}),
    counted("at_fault", "At fault", ({ at_fault }) => at_fault, { at_fault: "true" }),
    counted("avoidable", "Avoidable", ({ avoidable }) => avoidable, {
      accountability: "avoidable",
    }),
    counted("confirmed", "Confirmed", ({ confirmed }) => confirmed, { confirmation: "confirmed" }),
    counted("flaky", "Flaky", ({ flaky }) => flaky, { confirmation: "flaky" }),
    numeric("groups", "Groups", ({ groups }) => groups),
    {
      id: "first",
      title: "First",
      width: "92px",
      numeric: true,
      hint: "Simulations up to the first, itself included",
      cell: ({ kind, first }) => {
        const found = firsts.get(kind);
        const evaluation = found?.first_evaluation ?? first;
        return (
          <Link
            to="."
            search={{ tab: "ancestry", number: String(evaluation) }}
            title={`Evaluation ${evaluation}; evaluations are numbered from 0`}
            resetScroll={false}
          >
            {found ? count(found.first) : `evaluation ${evaluation}`}
          </Link>
        );
      },
    },
  ];
  return (
    <>
      <DataTable
        label="Kinds of failures"
        columns={kinds}
        rows={campaign.kinds}
        idOf={({ kind }) => kind}
        height="240px"
      />
      <Filters filters={FILTERS} search={search} />
      {chosen && (
        <p className="answer">
          Only {kindText(chosen)}.{" "}
          <Link to="." search={{ ...search, kind: "" }} resetScroll={false}>
            Show all kinds
          </Link>
        </p>
      )}
      <Violations campaign={campaign.id} />
    </>
  );
}

function numeric(id: string, title: string, of: (kind: Kind) => number | null): Column<Kind> {
  return {
    id,
    title,
    width: "92px",
    numeric: true,
    cell: (kind) => of(kind) ?? <span title="Not grouped yet">not yet</span>,
  };
}

/** A count that leads to the failures that it counts. */
function counted(
  id: string,
  title: string,
  of: (kind: Kind) => number,
  filter: Readonly<Record<string, string>>,
): Column<Kind> {
  return {
    id,
    title,
    width: "92px",
    numeric: true,
    cell: (kind) =>
      of(kind) === 0 ? (
        <span className="quiet">0</span>
      ) : (
        <Link to="." search={{ tab: "failures", kind: kind.kind, ...filter }} resetScroll={false}>
          {count(of(kind))}
        </Link>
      ),
  };
}

const CONFIRMED = {
  open: { sign: "○", tone: "quiet", text: "open" },
  confirmed: { sign: "✓", tone: "good", text: "confirmed" },
  flaky: { sign: "≈", tone: "lost", text: "flaky" },
} as const;

const COLUMNS: readonly Column<Failure>[] = [
  {
    id: "evaluation",
    title: "Evaluation",
    width: "84px",
    numeric: true,
    cell: ({ evaluation }) => (
      <Link to="." search={{ tab: "ancestry", number: String(evaluation) }} resetScroll={false}>
        {evaluation}
      </Link>
    ),
  },
  {
    id: "oracle",
    title: "Oracle",
    width: "120px",
    cell: ({ verdict }) => <OracleHelp name={verdict.oracle} />,
  },
  { id: "ego", title: "Ego", width: "76px", cell: ({ verdict }) => verdict.ego },
  {
    id: "time",
    title: "Time (s)",
    width: "76px",
    numeric: true,
    cell: ({ verdict }) => fixed(verdict.time, 2),
  },
  {
    id: "message",
    title: "What happened",
    width: "minmax(300px, 1fr)",
    cell: ({ verdict }) => <span title={verdict.message}>{verdict.message}</span>,
  },
  { id: "place", title: "Place", width: "140px", cell: ({ kind }) => wordsOfKind(kind).place },
  {
    id: "avoidable",
    title: "Avoidable",
    width: "116px",
    cell: ({ verdict }) =>
      verdict.at_fault === false ? (
        <span className="quiet">not at fault</span>
      ) : verdict.avoidable ? (
        plain(verdict.avoidable)
      ) : (
        <span className="quiet">not measured</span>
      ),
  },
  {
    id: "confirmation",
    title: "Second run",
    width: "106px",
    cell: ({ confirmation }) => <Mark {...CONFIRMED[confirmation]} />,
  },
];

function one<Value extends string>(allowed: readonly Value[], text: string): Value | undefined {
  return allowed.find((value) => value === text);
}

function Violations({ campaign }: { readonly campaign: string }) {
  const search = useSearch({ from: "/campaigns/$id" });
  const navigate = useNavigate();
  const kind = firstOf(search, "kind");
  const oracle = firstOf(search, "oracle");
  const accountability = one(ACCOUNTABILITIES, firstOf(search, "accountability"));
  const confirmation = one(CONFIRMATIONS, firstOf(search, "confirmation"));
  const atFault = firstOf(search, "at_fault");
  const filters = {
    ...(atFault ? { at_fault: atFault === "true" } : {}),
    ...(kind ? { kind } : {}),
    ...(oracle ? { oracle } : {}),
    ...(accountability ? { accountability } : {}),
    ...(confirmation ? { confirmation } : {}),
  };
  const { query, rows, more } = useList<Failure>(
    ["campaign", campaign, "failures", filters],
    async (page_token) =>
      body(
        await api.GET("/api/v1/campaigns/{campaign_id}/failures", {
          params: {
            path: { campaign_id: campaign },
            query: { limit: 200, ...filters, ...(page_token ? { page_token } : {}) },
          },
        }),
      ),
  );
  if (query.isPending) return <Loading />;
  if (query.isError) return <Refused error={query.error} />;
  if (rows.length === 0) return <p className="quiet">No failure passes these filters.</p>;
  return (
    <>
      <p className="quiet">
        {count(rows.length)}
        {query.hasNextPage ? " or more" : ""} violations
      </p>
      <DataTable
        label="Violations"
        columns={COLUMNS}
        rows={rows}
        idOf={({ evaluation, place }) => `${evaluation} ${place}`}
        onOpen={({ evaluation }) =>
          void navigate({
            to: ".",
            search: { tab: "ancestry", number: String(evaluation) },
            resetScroll: false,
          })
        }
        onEnd={more}
        height="52vh"
      />
    </>
  );
}
