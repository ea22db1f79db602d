import type { Search } from "../../address";
import type { Schemas } from "../../api/client";

type Counts = Schemas["RunCounts"];

/** A column of the matrix: what an oracle found, and the filter that has the same runs. */
export interface OutcomeColumn {
  readonly id: string;
  readonly title: string;
  readonly filter: Readonly<Record<string, string>>;
  /** Whether a number in it is a violation at an ego's fault. */
  readonly bad: boolean;
}

export const OUTCOMES: readonly OutcomeColumn[] = [
  {
    id: "at_fault",
    title: "An ego at fault",
    filter: { outcome: "violated", at_fault: "true" },
    bad: true,
  },
  {
    id: "not_at_fault",
    title: "No ego at fault",
    filter: { outcome: "violated", at_fault: "false" },
    bad: false,
  },
  { id: "violated", title: "All violated", filter: { outcome: "violated" }, bad: false },
  {
    id: "not_measurable",
    title: "Not measurable",
    filter: { outcome: "not_measurable" },
    bad: false,
  },
];

export interface MatrixRow {
  readonly oracle: string;
  readonly cells: readonly { readonly column: OutcomeColumn; readonly number: number }[];
}

/** Returns oracles by outcomes: those with most violations first. */
export function matrixOf(counts: readonly Counts[]): readonly MatrixRow[] {
  const oracles = new Set(counts.flatMap(({ oracle }) => Object.keys(oracle)));
  const rows = [...oracles].map((oracle) => ({
    oracle,
    cells: OUTCOMES.map((column, place) => ({
      column,
      number: counts[place]?.oracle[oracle] ?? 0,
    })),
  }));
  const rank = (row: MatrixRow) => numberOf(row, "at_fault") * 1e6 + numberOf(row, "violated");
  return rows.toSorted((a, b) => rank(b) - rank(a) || a.oracle.localeCompare(b.oracle));
}

/** Returns the address of the runs that a cell counts. */
export function searchOf(batch: string, oracle: string, column: OutcomeColumn): Search {
  return { batch, oracle, ...column.filter };
}

/** Returns the oracles with runs in which the fault is open: not attributed, or undetermined. */
export function faultOpen(rows: readonly MatrixRow[]): readonly string[] {
  return rows
    .filter(
      (row) =>
        numberOf(row, "violated") > numberOf(row, "at_fault") + numberOf(row, "not_at_fault"),
    )
    .map(({ oracle }) => oracle);
}

function numberOf({ cells }: MatrixRow, id: string): number {
  return cells.find(({ column }) => column.id === id)?.number ?? 0;
}
