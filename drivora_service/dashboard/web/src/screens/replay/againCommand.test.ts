import { expect, it } from "vitest";
import { againCommand, rejudgeCommand } from "./againCommand";

const SERVER = "http://127.0.0.1:8000";

it("a run with a result is replayed, and so is one that failed by itself", () => {
  for (const status of ["finished", "agent_failed", "timed_out"] as const)
    expect(againCommand({ id: "a1", status, cause: "" }, SERVER)).toBe(
      "drivora replay a1 --server http://127.0.0.1:8000",
    );
});

it("the scenario of a run without a result is driven again", () => {
  const expected =
    "drivora runs scenario a1 --server http://127.0.0.1:8000 --out a1.json && drivora run a1.json";
  for (const status of ["cancelled", "infrastructure_failed"] as const)
    expect(againCommand({ id: "a1", status, cause: "worker_lost" }, SERVER)).toBe(expected);
  const quarantined = { id: "a1", status: "simulator_crashed", cause: "quarantined" } as const;
  expect(againCommand(quarantined, SERVER)).toBe(expected);
});

it("a run is judged again if another version of the oracles has judged it", () => {
  expect(rejudgeCommand({ id: "a1", judged_by_other_oracles: true }, SERVER)).toBe(
    "drivora rejudge a1 --server http://127.0.0.1:8000",
  );
  expect(rejudgeCommand({ id: "a1", judged_by_other_oracles: false }, SERVER)).toBe("");
});
