import { describe, expect, it } from "vitest";
import type { Schemas } from "../../api/client";
import { lawCurves, robustnessAt } from "./lawCurves";

type Verdict = Schemas["Verdict"];

function verdict(oracle: string, evidence: Verdict["evidence"], ego = "ego_0"): Verdict {
  return { oracle, ego, outcome: "violated", message: "m", evidence } as Verdict;
}

function curve(...robustness: readonly number[]) {
  return {
    curve_times: robustness.map((_, k) => k),
    curve_robustness: robustness,
    formula: "always (speed < 3)",
  };
}

describe("curves of laws", () => {
  it("are those of the violated laws of an ego, the most violated first", () => {
    const found = lawCurves(
      [
        verdict("collision", { speed: 3 }),
        verdict("law_a", curve(1, -0.1)),
        verdict("law_b", curve(1, -0.5)),
        verdict("law_b", curve(1, -0.9)),
        verdict("law_c", curve(1, -0.9), "ego_1"),
        verdict("law_d", { robustness: 0.2 }),
      ],
      "ego_0",
    );
    expect(found.map(({ oracle }) => oracle)).toEqual(["law_b", "law_a"]);
    expect([...(found[0]?.robustness ?? [])]).toEqual([1, -0.5]);
    expect(found[0]?.formula).toBe("always (speed < 3)");
  });

  it("need times and values of one length", () => {
    const odd = { ...curve(1, 2), curve_times: [0] };
    const words = { ...curve(1), curve_times: ["a"] };
    expect(lawCurves([verdict("a", odd), verdict("b", words)], "ego_0")).toEqual([]);
  });

  it("have the value of the last point before a time", () => {
    const [law] = lawCurves([verdict("a", curve(0.5, -0.2, 0.1))], "ego_0");
    if (!law) throw new Error("no curve");
    expect([-1, 0, 1.5, 9].map((time) => robustnessAt(law, time))).toEqual([
      undefined,
      0.5,
      -0.2,
      0.1,
    ]);
  });
});
