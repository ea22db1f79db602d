import type { Search } from "../../address";
import type { Schemas } from "../../api/client";
import type { SignedInterval } from "../../components/charts/SignedIntervals";
import type { Cell } from "../../lists/csv";
import { plain } from "../failures/words";
import { replayUpTo } from "../replay/address";

export type Comparison = Schemas["BatchComparison"];
export type Pair = Schemas["PairResult"];
export type WhichFails = Schemas["WhichFails"];
type Metric = Schemas["MetricComparison"];
type Result = Schemas["RunResult"];
type Failure = Schemas["FailureComparison"];

/** Which pairs are listed: those that tell A from B unless the address says otherwise. */
export const SHOWN = {
  telling: "that tell A from B",
  b_only: "in which only B fails",
  a_only: "in which only A fails",
  both: "in which both fail",
  neither: "in which neither fails",
  all: "all of them",
} as const;
export type Shown = keyof typeof SHOWN;

export function shownOf(word: string): Shown {
  return word in SHOWN ? (word as Shown) : "telling";
}

const oracles = ({ failures }: Result) => new Set(failures.map(({ oracle }) => oracle));

/** Whether A and B fail by other oracles, or only one of them. */
export function tellsApart({ a, b }: Pair): boolean {
  const [mine, theirs] = [oracles(a), oracles(b)];
  return mine.size !== theirs.size || [...mine].some((oracle) => !theirs.has(oracle));
}

/** Returns the pairs that are listed; with an oracle, by the failures of that oracle alone. */
export function pairsShown(pairs: readonly Pair[], shown: Shown, oracle: string): readonly Pair[] {
  const wanted = oracle === "" ? pairs : pairs.map((pair) => byOracle(pair, oracle));
  if (shown === "all") return wanted;
  if (shown === "telling") return wanted.filter(tellsApart);
  return wanted.filter(({ fails }) => fails === shown);
}

/** Returns a pair with the failures of one oracle only. */
function byOracle(pair: Pair, oracle: string): Pair {
  const only = (result: Result): Result => ({
    ...result,
    failures: result.failures.filter((one) => one.oracle === oracle),
  });
  const [a, b] = [only(pair.a), only(pair.b)];
  return { ...pair, a, b, fails: whichFails(a.failures.length > 0, b.failures.length > 0) };
}

function whichFails(a: boolean, b: boolean): WhichFails {
  if (a === b) return a ? "both" : "neither";
  return a ? "a_only" : "b_only";
}

/** Returns the failures of a run in words; the first sentence is the caller's to show. */
export function failuresText({ failures }: Result): string {
  return failures.map(({ oracle }) => plain(oracle)).join(", ") || "none";
}

/** Returns the search of a link that shows both runs, from just before they are told apart. */
export function bothReplayed({ a, b }: Pair): Search {
  const [mine, theirs] = [oracles(a), oracles(b)];
  const alone = [
    ...a.failures.filter(({ oracle }) => !theirs.has(oracle)),
    ...b.failures.filter(({ oracle }) => !mine.has(oracle)),
  ];
  const times = (alone.length > 0 ? alone : [...a.failures, ...b.failures]).flatMap(({ time }) =>
    time == null ? [] : [time],
  );
  return {
    with: b.run,
    view: "side",
    ...(times.length > 0 ? replayUpTo(Math.min(...times)) : {}),
  };
}

/** Returns a number of a metric with so many digits that differences are seen. */
export function shortNumber(value: number): string {
  return String(Number(value.toPrecision(4)));
}

/** Returns a difference with its sign, in three digits. */
export function signed(value: number): string {
  const text = String(Math.abs(Number(value.toPrecision(3))));
  return value > 0 ? `+${text}` : value < 0 ? `−${text}` : text;
}

function intervalText(low: number | null, high: number | null): string {
  return low === null || high === null ? "" : ` [${signed(low)}, ${signed(high)}]`;
}

/** Returns the name of the test of failures: with several pairs of a scenario it is another one. */
export function failureTest(pairs: number, scenarios: number): string {
  return pairs > scenarios ? "exact sign test over scenarios" : "McNemar’s exact test";
}

/** Returns p as text, with no more digits than it deserves. */
export function probability(p: number): string {
  if (p < 0.001) return "< 0.001";
  return p < 0.1 ? p.toFixed(3) : p.toFixed(2);
}

/** Returns the metrics with a difference, as rows of a figure: those with a direction point right where B is better. */
export function differences(
  metrics: readonly Metric[],
  directed: boolean,
): readonly SignedInterval[] {
  return metrics
    .filter(({ better, difference }) => (better !== "neither") === directed && difference)
    .toSorted((a, b) => a.p - b.p)
    .map((row) => {
      const sign = row.better === "lower" ? -1 : 1;
      const ends = [row.low, row.high].flatMap((end) => (end === null ? [] : [end * sign]));
      return {
        name: plain(row.metric),
        value: (row.difference ?? 0) * sign,
        low: ends.length === 2 ? Math.min(...ends) : undefined,
        high: ends.length === 2 ? Math.max(...ends) : undefined,
        look: row.judgement === "undecided" ? "other" : "series-0",
        words: wordsOf(row),
      };
    });
}

function wordsOf(row: Metric): string {
  const { mean_a, mean_b, difference, unit, judgement } = row;
  if (mean_a === null || mean_b === null || difference === null) return "";
  const of = unit === "" || unit === "1" ? "" : ` ${unit}`;
  const means = `${shortNumber(mean_a)} → ${shortNumber(mean_b)}${of}`;
  return `${means}, ${signed(difference)}${intervalText(row.low, row.high)} ${judgement}`;
}

/** Returns the difference of the shares of failing scenarios, in percentage points. */
export function pointsText({ difference, low, high }: Failure): string {
  if (difference === null) return "";
  const points = (share: number | null) => share && Math.round(share * 1000) / 10;
  return `${signed(difference * 100)}${intervalText(points(low), points(high))}`;
}

/** Returns the lines of a file with every pair. */
export function csvRows(pairs: readonly Pair[]): readonly (readonly Cell[])[] {
  const metrics = Object.keys(pairs[0]?.a.metrics ?? {});
  const of = (result: Result): Record<string, Cell> => ({
    run: result.run,
    status: result.status,
    failures: result.failures.map(({ oracle }) => oracle).join(" "),
    sentences: result.failures.map(({ sentence }) => sentence).join(" "),
    ...result.metrics,
  });
  const names = ["run", "status", "failures", "sentences", ...metrics];
  const columns = ["scenario", "seed", "town", "fails", "same_trace"];
  return [
    [...columns, ...names.flatMap((name) => [`${name}_a`, `${name}_b`])],
    ...pairs.map((pair) => {
      const [a, b] = [of(pair.a), of(pair.b)];
      return [
        pair.scenario,
        pair.seed,
        pair.town,
        pair.fails,
        pair.same_trace,
        ...names.flatMap((name) => [a[name], b[name]]),
      ];
    }),
  ];
}
