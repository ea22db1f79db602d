import { describe, expect, it } from "vitest";
import {
  actionsOf,
  type Batch,
  isPriority,
  lookOfBatch,
  olderFirst,
  sharesOf,
  standingOf,
} from "./batch";

const batch = (part: Partial<Batch>) =>
  ({
    state: "open",
    size: 10,
    violated_runs: 2,
    done: false,
    counts: { finished: 5, queued: 2, running: 1, timed_out: 1, cancelled: 1 },
    ...part,
  }) as Batch;

describe("a batch", () => {
  it("counts what was not judged apart from what passed", () => {
    expect(standingOf(batch({}))).toEqual({
      waiting: 2,
      running: 1,
      violated: 2,
      passed: 3,
      notJudged: 1,
      cancelled: 1,
      ended: 7,
    });
  });
  it("has a bar whose rest is what waits", () => {
    const told = sharesOf(batch({})).reduce((sum, { number }) => sum + number, 0);
    expect(told).toBe(8);
  });
  it("has one of the priorities of the API, whatever an address says", () => {
    expect(["ci", "late", "campaign"].filter(isPriority)).toEqual(["ci", "campaign"]);
  });
  it("offers only what its state allows", () => {
    expect(actionsOf(batch({}))).toEqual(["pause", "cancel"]);
    expect(actionsOf(batch({ state: "paused" }))).toEqual(["resume", "cancel"]);
    expect(actionsOf(batch({ state: "cancelled" }))).toEqual([]);
    expect(actionsOf(batch({ done: true }))).toEqual([]);
  });
  it("is compared with a newer one, which is B", () => {
    const [a, b] = [
      batch({ id: "1", created_at: "2026-03-02T09:30:00Z" }),
      batch({ id: "0", created_at: "2026-03-01T23:59:59Z" }),
    ].toSorted(olderFirst);
    expect([a?.id, b?.id]).toEqual(["0", "1"]);
  });
  it("is paused only as long as runs wait", () => {
    expect(lookOfBatch(batch({ state: "paused" })).text).toBe("paused");
    expect(lookOfBatch(batch({ state: "paused", done: true })).text).toBe("ended");
  });
});
