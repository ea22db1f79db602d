import { Link, useNavigate } from "@tanstack/react-router";
import { useMemo } from "react";
import { firstOf, type Search } from "../../address";
import { Choice } from "../../components/Choice";
import { type Column, DataTable } from "../../components/DataTable";
import { Mark, type MarkLook } from "../../components/Mark";
import { count, fixed } from "../../components/numbers";
import { plain } from "../failures/words";
import {
  bothReplayed,
  type Comparison,
  failuresText,
  type Pair,
  pairsShown,
  SHOWN,
  shownOf,
  signed,
  type WhichFails,
} from "./paired";
import { inOrder, nextOrder, orderOf, type PairOrder } from "./pairOrder";

const LOOKS: Readonly<Record<WhichFails, MarkLook>> = {
  b_only: { sign: "✕", tone: "bad", text: "only B" },
  a_only: { sign: "✓", tone: "good", text: "only A" },
  both: { sign: "=", tone: "quiet", text: "both" },
  neither: { sign: "○", tone: "quiet", text: "neither" },
};

const idOf = ({ a, b }: Pair) => `${a.run} ${b.run}`;

/** Every pair of runs, those that tell A from B first; a row opens both replays side by side. */
export function PairTable({
  found,
  search,
}: {
  readonly found: Comparison;
  readonly search: Search;
}) {
  const navigate = useNavigate();
  const shown = shownOf(firstOf(search, "show"));
  const oracle = firstOf(search, "oracle");
  const sort = firstOf(search, "sort");
  const rows = useMemo(
    () => inOrder(pairsShown(found.pairs, shown, oracle), orderOf(sort)),
    [found.pairs, shown, oracle, sort],
  );
  const columns = useMemo(
    () =>
      columnsOf(found).map((column) =>
        UNSORTED.has(column.id)
          ? column
          : sortable(column, orderOf(sort), (word) =>
              navigate({
                to: ".",
                search: { ...search, sort: word || undefined },
                replace: true,
                resetScroll: false,
              }),
            ),
      ),
    [found, sort, search, navigate],
  );
  return (
    <section className="panel pairs">
      <header>
        <h2>{count(rows.length)} pairs</h2>
        <Choice
          name="show"
          title=""
          label="Which pairs"
          value={shown}
          options={Object.entries(SHOWN).map(([value, text]) => ({ value, text }))}
          search={search}
        />
        <Choice
          name="oracle"
          title="by"
          value={oracle}
          options={[
            { value: "", text: "any oracle" },
            ...found.by_oracle.map(({ oracle: name }) => ({ value: name, text: plain(name) })),
          ]}
          search={search}
        />
      </header>
      {rows.length === 0 ? (
        <p className="quiet note">No pair is among these.</p>
      ) : (
        <DataTable
          label="Pairs"
          columns={columns}
          rows={rows}
          idOf={idOf}
          onOpen={(pair) =>
            void navigate({
              to: "/runs/$runId",
              params: { runId: pair.a.run },
              search: bothReplayed(pair),
            })
          }
          height="min(60vh, 640px)"
        />
      )}
    </section>
  );
}

const UNSORTED: ReadonlySet<string> = new Set(["a", "b", "trace"]);

/** Returns a column whose header changes the order of the rows. */
function sortable(
  column: Column<Pair>,
  now: PairOrder | undefined,
  sort: (word: string) => void,
): Column<Pair> {
  const sorted = now?.by === column.id ? (now.descending ? "descending" : "ascending") : undefined;
  return { ...column, sorted, onSort: () => sort(nextOrder(now, column.id)) };
}

function columnsOf({ pairs, scenarios }: Comparison): readonly Column<Pair>[] {
  const metrics = Object.keys(pairs[0]?.a.metrics ?? {});
  const repeated = pairs.length > scenarios;
  return [
    {
      id: "scenario",
      title: "Scenario",
      width: "minmax(140px, 1fr)",
      cell: (pair) => (
        <Link
          to="/runs/$runId"
          params={{ runId: pair.a.run }}
          search={bothReplayed(pair)}
          title="Both replays side by side"
        >
          {pair.scenario}
        </Link>
      ),
    },
    ...(repeated
      ? [
          {
            id: "seed",
            title: "Seed",
            width: "70px",
            numeric: true,
            cell: ({ seed }: Pair) => String(seed),
          },
        ]
      : []),
    { id: "fails", title: "Fails", width: "90px", cell: ({ fails }) => <Mark {...LOOKS[fails]} /> },
    ...(["a", "b"] as const).map((side) => ({
      id: side,
      title: `Failures of ${side.toUpperCase()}`,
      width: "minmax(120px, 1fr)",
      cell: (pair: Pair) => (
        <Link
          to="/runs/$runId"
          params={{ runId: pair[side].run }}
          search={{}}
          className="ink"
          title={pair[side].failures.map(({ sentence }) => sentence).join("\n")}
        >
          {failuresText(pair[side])}
        </Link>
      ),
    })),
    ...metrics.flatMap((name) => [
      ...(["a", "b"] as const).map((side) => ({
        id: `${name} ${side}`,
        title: `${plain(name)} ${side.toUpperCase()}`,
        width: "124px",
        numeric: true,
        cell: (pair: Pair) => fixed(pair[side].metrics[name], 1) || "not measurable",
      })),
      {
        id: `${name} difference`,
        title: "B − A",
        hint: `${plain(name)} of B less that of A`,
        width: "80px",
        numeric: true,
        cell: ({ a, b }: Pair) => {
          const [ofA, ofB] = [a.metrics[name], b.metrics[name]];
          return ofA == null || ofB == null ? "" : signed(ofB - ofA);
        },
      },
    ]),
    // Two ADSs hardly ever drive alike: the column is there where it tells pairs apart.
    ...(pairs.some(({ same_trace }) => same_trace)
      ? [
          {
            id: "trace",
            title: "Trace",
            hint: "Whether both runs are the same, step by step",
            width: "80px",
            cell: ({ same_trace }: Pair) =>
              same_trace ? "same" : <span className="quiet">differs</span>,
          },
        ]
      : []),
  ];
}
