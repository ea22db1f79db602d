import { expect, it } from "vitest";
import {
  alwaysPasses,
  changeSentence,
  changesBetween,
  type History,
  type Outcome,
  runsByDriver,
  type ScenarioState,
  shareWords,
  turnOf,
} from "./suite";

function outcome(state: ScenarioState): Outcome {
  return { scenario: "a", state, failing: 0, judged: 1, score: null, run_id: "r", failures: [] };
}

it("shares have their interval", () => {
  expect(shareWords({ mean: 2 / 3, low: 0.21, high: 0.94 })).toBe("67 % (21 to 94)");
  expect(shareWords({ mean: 1, low: null, high: null })).toBe("100 %");
});

it("a scenario turns better or worse where passing changes", () => {
  expect(turnOf(outcome("passes"), outcome("fails_gate"))).toBe("worse");
  expect(turnOf(outcome("flaky"), outcome("known"))).toBe("better");
  expect(turnOf(outcome("fails_gate"), outcome("not_judged"))).toBe("other");
  expect(turnOf(outcome("passes"), outcome("passes"))).toBeUndefined();
  expect(turnOf(null, outcome("passes"))).toBeUndefined();
});

it("scenarios that changed are told, the worse first", () => {
  const line = (scenario: string, ...states: (ScenarioState | null)[]) => ({
    scenario,
    outcomes: states.map((state) => state && outcome(state)),
  });
  const history: History = {
    suite: "s",
    runs: [],
    scenarios: [
      line("better", "fails_gate", "passes"),
      line("same", "passes", "passes"),
      line("new", null, "passes"),
      line("worse", "passes", "fails_gate"),
    ],
  };
  const changes = changesBetween(history, 0, 1);
  expect(changes.map(({ line }) => line.scenario)).toEqual(["worse", "better"]);
  expect(changeSentence(changes)).toBe("1 fail now and did not, 1 pass now and did not.");
  expect(changeSentence([])).toBe("No scenario changed.");
  expect(history.scenarios.filter(alwaysPasses).map(({ scenario }) => scenario)).toEqual([
    "same",
    "new",
  ]);
});

it("the ADSs that drove a suite are counted, runs of each scenario's own are not", () => {
  expect(runsByDriver([{ agent: "idm" }, { agent: "" }, { agent: "idm" }])).toEqual({ idm: 2 });
});
