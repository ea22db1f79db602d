import type { Pair } from "./paired";

/** Which values of a pair its table is sorted by, and the side for a metric. */
export interface PairOrder {
  readonly by: string;
  readonly descending: boolean;
}

/** Returns the order that an address names: `-driving_score b` is descending; empty: none. */
export function orderOf(word: string): PairOrder | undefined {
  const descending = word.startsWith("-");
  const by = descending ? word.slice(1) : word;
  return by === "" ? undefined : { by, descending };
}

/** Returns the word for the next press on a column: ascending, then descending, then none. */
export function nextOrder(now: PairOrder | undefined, by: string): string {
  if (now?.by !== by) return by;
  return now.descending ? "" : `-${by}`;
}

/** Returns the pairs in an order; those without the value are last in both directions. */
export function inOrder(pairs: readonly Pair[], order: PairOrder | undefined): readonly Pair[] {
  if (!order) return pairs;
  const turn = order.descending ? -1 : 1;
  return pairs.toSorted((one, other) => {
    const [a, b] = [valueBy(one, order.by), valueBy(other, order.by)];
    if (a === undefined || b === undefined)
      return Number(a === undefined) - Number(b === undefined);
    if (typeof a === "number" && typeof b === "number") return turn * (a - b);
    return turn * String(a).localeCompare(String(b), undefined, { numeric: true });
  });
}

function valueBy(pair: Pair, by: string): string | number | undefined {
  if (by === "scenario" || by === "fails") return pair[by];
  if (by === "seed") return pair.seed;
  const [metric = "", side] = by.split(" ");
  const [a, b] = [pair.a.metrics[metric] ?? undefined, pair.b.metrics[metric] ?? undefined];
  if (side === "a") return a;
  if (side === "b") return b;
  return a === undefined || b === undefined ? undefined : b - a;
}
