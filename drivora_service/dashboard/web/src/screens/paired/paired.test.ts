import { describe, expect, it } from "vitest";
import type { Schemas } from "../../api/client";
import { reachOf } from "../../components/charts/SignedIntervals";
import {
  bothReplayed,
  csvRows,
  differences,
  failuresText,
  failureTest,
  type Pair,
  pairsShown,
  pointsText,
  probability,
  shownOf,
} from "./paired";
import { inOrder, nextOrder, orderOf } from "./pairOrder";

const result = (run: string, ...failures: readonly (readonly [string, number | null])[]) => ({
  run,
  status: "finished" as const,
  metrics: { driving_score: run === "a" ? 80 : null },
  failures: failures.map(([oracle, time]) => ({
    oracle,
    time,
    sentence: `${oracle}, at last`,
    violations: 1,
  })),
});
const pair = (
  scenario: string,
  fails: Pair["fails"],
  a: readonly string[],
  b: readonly string[],
): Pair => ({
  scenario,
  seed: 1,
  town: "tee-town",
  fails,
  scenario_fails: fails,
  same_trace: false,
  a: result("a", ...a.map((oracle) => [oracle, 9] as const)),
  b: result("b", ...b.map((oracle) => [oracle, 12] as const)),
});
const PAIRS = [
  pair("new", "b_only", [], ["collision"]),
  pair("repaired", "a_only", ["red_light"], []),
  pair("other", "both", ["collision"], ["collision", "red_light"]),
  pair("still", "both", ["collision"], ["collision"]),
  pair("well", "neither", [], []),
];
const names = (pairs: readonly Pair[]) => pairs.map(({ scenario }) => scenario);

describe("the listed pairs", () => {
  it("are those that tell A from B, unless others are asked for", () => {
    expect(names(pairsShown(PAIRS, shownOf(""), ""))).toEqual(["new", "repaired", "other"]);
    expect(names(pairsShown(PAIRS, shownOf("both"), ""))).toEqual(["other", "still"]);
    expect(names(pairsShown(PAIRS, "all", ""))).toHaveLength(5);
    expect(shownOf("luck")).toBe("telling");
  });
  it("are judged by one oracle where one is asked for", () => {
    expect(names(pairsShown(PAIRS, "telling", "collision"))).toEqual(["new"]);
    expect(names(pairsShown(PAIRS, "b_only", "red_light"))).toEqual(["other"]);
    const [other] = pairsShown(PAIRS, "b_only", "red_light");
    expect(other && failuresText(other.b)).toBe("red light");
    expect(names(pairsShown(PAIRS, "both", "collision"))).toEqual(["other", "still"]);
  });
});

describe("the order of pairs", () => {
  const scored = (scenario: string, a: number, b: number | null): Pair => {
    const made = pair(scenario, "neither", [], []);
    return {
      ...made,
      a: { ...made.a, metrics: { driving_score: a } },
      b: { ...made.b, metrics: { driving_score: b } },
    };
  };
  const some = [scored("s10", 90, 20), scored("s9", 50, null), scored("s2", 10, 60)];
  it("is by a metric of a side or by the difference, what is not measurable last", () => {
    expect(names(inOrder(some, orderOf("driving_score b")))).toEqual(["s10", "s2", "s9"]);
    expect(names(inOrder(some, orderOf("-driving_score b")))).toEqual(["s2", "s10", "s9"]);
    expect(names(inOrder(some, orderOf("driving_score difference")))).toEqual(["s10", "s2", "s9"]);
    expect(names(inOrder(some, orderOf("-driving_score a")))).toEqual(["s10", "s9", "s2"]);
  });
  it("takes numbers in names as numbers", () => {
    expect(names(inOrder(some, orderOf("scenario")))).toEqual(["s2", "s9", "s10"]);
  });
  it("is ascending, descending and none, one press after the other", () => {
    expect(nextOrder(undefined, "fails")).toBe("fails");
    expect(nextOrder(orderOf("fails"), "fails")).toBe("-fails");
    expect(nextOrder(orderOf("-fails"), "fails")).toBe("");
    expect(nextOrder(orderOf("-fails"), "seed")).toBe("seed");
  });
});

describe("a link to both replays", () => {
  const search = (of: string) => {
    const found = PAIRS.find(({ scenario }) => scenario === of);
    return found && bothReplayed(found);
  };
  it("begins before the failure that only one of them has", () => {
    expect(search("other")).toEqual({ with: "b", view: "side", t: "8.00" });
    expect(search("repaired")).toEqual({ with: "b", view: "side", t: "5.00" });
  });
  it("begins before the first one where both have the same, and at the start without any", () => {
    expect(search("still")).toEqual({ with: "b", view: "side", t: "5.00" });
    expect(search("well")).toEqual({ with: "b", view: "side" });
  });
});

const metric = (part: Partial<Schemas["MetricComparison"]>): Schemas["MetricComparison"] => ({
  metric: "driving_score",
  unit: "%",
  better: "higher",
  scenarios: 20,
  pairs: 20,
  not_measurable: 0,
  mean_a: 70,
  mean_b: 74.5,
  difference: 4.5,
  low: 1.25,
  high: 8,
  p: 0.01,
  p_holm: 0.02,
  judgement: "better",
  ...part,
});

describe("metrics as a figure", () => {
  it("point to the right where B is better, whatever the direction of the metric", () => {
    const drac = metric({ metric: "max_drac_mps2", unit: "m/s²", better: "lower", p: 0.001 });
    const [first, second] = differences([metric({}), drac], true);
    expect(first).toMatchObject({ name: "max drac mps2", value: -4.5, low: -8, high: -1.25 });
    expect(second).toMatchObject({ value: 4.5, low: 1.25, high: 8, look: "series-0" });
    expect(second?.words).toBe("70 → 74.5 %, +4.5 [+1.25, +8] better");
  });
  it("leave out what does not differ, and keep what only describes apart", () => {
    const same = metric({ difference: 0 });
    const unknown = metric({ difference: null, mean_a: null, low: null, high: null });
    const speed = metric({ metric: "mean_speed_mps", better: "neither", judgement: "higher" });
    expect(differences([same, unknown, speed], true)).toEqual([]);
    expect(differences([same, unknown, speed], false).map(({ name }) => name)).toEqual([
      "mean speed mps",
    ]);
  });
  it("have a dot alone where there is no interval", () => {
    const [row] = differences([metric({ low: null, high: null, judgement: "undecided" })], true);
    expect(row).toMatchObject({ low: undefined, high: undefined, look: "other" });
    expect(row && reachOf(row)).toBe(4.5);
  });
});

it("shares are told in percentage points, and p with few digits", () => {
  const failures = { difference: -0.08, low: -0.155, high: 0.0012 };
  expect(pointsText(failures as Schemas["FailureComparison"])).toBe("−8 [−15.5, +0.1]");
  expect([0.0002, 0.0312, 0.25].map(probability)).toEqual(["< 0.001", "0.031", "0.25"]);
});

it("a file has a line for each pair, with the values of both runs", () => {
  const [head, line] = csvRows(PAIRS.slice(2, 3));
  expect(head?.slice(4)).toEqual([
    "same_trace",
    "run_a",
    "run_b",
    "status_a",
    "status_b",
    "failures_a",
    "failures_b",
    "sentences_a",
    "sentences_b",
    "driving_score_a",
    "driving_score_b",
  ]);
  expect(line?.slice(9)).toEqual([
    "collision",
    "collision red_light",
    "collision, at last",
    "collision, at last red_light, at last",
    80,
    null,
  ]);
});

it("the test behind p is named: with several seeds of a scenario it is another one", () => {
  expect(failureTest(8, 8)).toBe("McNemar’s exact test");
  expect(failureTest(24, 8)).toBe("exact sign test over scenarios");
});
