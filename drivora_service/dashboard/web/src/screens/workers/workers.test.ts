import { describe, expect, it } from "vitest";
import { megabytes, phaseOf, type Slot, secondsSince, standing, type Workers } from "./workers";

const slot = (part: Partial<Slot>) =>
  ({ name: "slot-0", state: "idle", phase: "idle", since: null, ...part }) as Slot;
const workers = (part: Partial<Workers>) => ({ slots: [], queue: [], ...part }) as Workers;

describe("workers", () => {
  it("are told of in a sentence", () => {
    const slots = [slot({ state: "running" }), slot({})];
    const queue = [
      { priority: "ci", queued: 1, paused: 0, running: 1 },
      { priority: "campaign", queued: 0, paused: 1200, running: 0 },
    ] as const;
    expect(standing(workers({ slots, queue: [...queue] }))).toBe(
      "1 of 2 workers run, 1 run waits, 1,200 paused",
    );
    expect(standing(workers({}))).toBe("No worker, no run waits");
  });
  it("say a phase only where it says more than the state", () => {
    expect(phaseOf(slot({}))).toBe("");
    expect(phaseOf(slot({ state: "running", phase: "loading_network" }))).toBe("loading network");
  });
  it("never do something since the future, and not since ever", () => {
    const since = "2026-03-02T09:30:10Z";
    expect(secondsSince(slot({ since }), Date.parse(since) + 2500)).toBe(2.5);
    expect(secondsSince(slot({ since }), Date.parse(since) - 2500)).toBe(0);
    expect(secondsSince(slot({}), 0)).toBeUndefined();
  });
  it("show no memory where there is no process", () => {
    expect(megabytes(0)).toBe("");
    expect(megabytes(213_110_784)).toBe("213");
  });
});
