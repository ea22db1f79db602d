import { describe, expect, it } from "vitest";
import type { Schemas } from "../../api/client";
import { lookOfRun, NOT_JUDGED } from "./status";

const run = (part: Partial<Schemas["RunSummary"]>) =>
  ({ status: "finished", violations: 0, ...part }) as Schemas["RunSummary"];

describe("a run's result", () => {
  it("is red only where an ego is at fault", () => {
    const tone = (accountability: Schemas["Accountability"]) =>
      lookOfRun(run({ violations: 1, accountability })).tone;
    expect(tone("avoidable")).toBe("bad");
    expect(tone("unavoidable")).toBe("bad");
    expect(tone("not_at_fault")).toBe("lost");
    expect(tone("not_judged")).toBe("lost");
  });
  it("never looks like a passed run where the run was not judged", () => {
    for (const status of NOT_JUDGED) expect(lookOfRun(run({ status })).tone).not.toBe("good");
  });
});
