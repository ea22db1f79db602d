import { expect, it } from "vitest";
import { touches } from "./keys";

it("a change of a run touches its batch, campaign and study", () => {
  const change = { kind: "run", id: "r", batch_id: "b", campaign_id: "c", study_id: "s" } as const;
  expect(touches(change)).toEqual([
    "run r",
    "run list",
    "batch b",
    "batch list",
    "campaign c",
    "campaign list",
    "study s",
    "study list",
  ]);
});
it("a change without owners touches itself and its list", () => {
  expect(touches({ kind: "campaign", id: "c" })).toEqual(["campaign c", "campaign list"]);
});
it("a change of a minimisation touches it, its list and the batch of its runs", () => {
  expect(touches({ kind: "minimization", id: "m", batch_id: "b" })).toEqual([
    "minimization m",
    "minimization list",
    "batch b",
    "batch list",
  ]);
});
