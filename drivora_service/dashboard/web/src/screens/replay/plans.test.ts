import { describe, expect, it } from "vitest";
import { AgentTold } from "./plans";

describe("what agents told", () => {
  const told = new AgentTold(0.1, 50);
  for (const step of [4, 8, 30])
    told.addPlan(0, { step, points: Float32Array.of(step, 0, step + 1, 0) });
  it("is the newest plan, as long as it is not older than a second", () => {
    expect(told.planAt(0, 3)).toBeUndefined();
    expect(told.planAt(0, 7)?.step).toBe(4);
    expect(told.planAt(0, 8)?.step).toBe(8);
    expect(told.planAt(0, 18)?.step).toBe(8);
    expect(told.planAt(0, 19)).toBeUndefined();
    expect(told.planAt(1, 8)).toBeUndefined();
  });
  it("is the numbers of its log at a step", () => {
    told.addValue("risk", 0, 5, 0.5);
    told.addValue("other", 0, 5, Number.NaN);
    expect(told.valuesAt(0, 5)).toEqual([["risk", 0.5]]);
    expect(told.valuesAt(0, 6)).toEqual([]);
  });
});
