import { expect, it } from "vitest";
import { changeWords, countWords, isTime, lookOfGroup, titleOf } from "./triage";

it("a group is called by its label, else by what its failures have in common", () => {
  const names = ["collision|npc_vehicle, front|following", "red_light"];
  expect(titleOf({ label: "late braking", names })).toBe("late braking");
  expect(titleOf({ label: "", names })).toBe(
    "collision · npc vehicle, front · following; red light",
  );
});

it("a fixed group that was found again stands out", () => {
  expect(lookOfGroup({ status: "fixed", is_back: false }).tone).toBe("good");
  expect(lookOfGroup({ status: "fixed", is_back: true }).tone).toBe("bad");
});

it("counts say how many count", () => {
  const none = { avoidable: 0, preventable: 0 };
  expect(countWords({ ...none, failures: 12, avoidable: 3 })).toBe("12 failures, 3 avoidable");
  expect(countWords({ ...none, failures: 1 })).toBe("1 failure");
  expect(countWords({ ...none, failures: 5, preventable: 2 })).toBe(
    "5 failures, 2 not at fault, but avoidable",
  );
  expect(countWords({ ...none, failures: 0 })).toBe("none left");
});

it("changes are told in words", () => {
  const change = { at: "2026-03-02T09:30:40Z", by: "Ada" };
  expect(changeWords({ ...change, what: "status", before: "new", after: "will_not_fix" })).toBe(
    "status: new → will not fix",
  );
  expect(changeWords({ ...change, what: "assignee", before: "", after: "Bo" })).toBe(
    "assignee: none → Bo",
  );
  expect(changeWords({ ...change, what: "note", before: "", after: "Seen." })).toBe("noted: Seen.");
  expect(changeWords({ ...change, what: "merged", before: "", after: "b" })).toBe(
    "merged b into it",
  );
  expect(changeWords({ ...change, what: "split", before: "2 failures", after: "" })).toBe(
    "split off 2 failures",
  );
  expect(changeWords({ ...change, what: "split", before: "a", after: "b" })).toBe("split it off a");
});

it("a baseline is a time or an id", () => {
  expect(isTime("2026-11-20T08:00:00.000Z")).toBe(true);
  expect(isTime("0193a5b0c4d200000000001b")).toBe(false);
});
