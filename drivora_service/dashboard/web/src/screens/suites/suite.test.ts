import { expect, it } from "vitest";
import {
  alwaysPasses,
  changeSentence,
  changesBetween,
  comparedRuns,
  configurationsOf,
  driverOf,
  type History,
  labelStride,
  type Outcome,
  runNames,
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

it("an ADS and its slowed version are two that drove a suite, named by their parameters", () => {
  const plain = { agent: "idm", agent_parameters: [], configuration: "idm" };
  const slowed = { ...plain, configuration: "idm · reaction_time 1.0" };
  expect([plain, slowed].map(driverOf)).toEqual(["idm", "idm · reaction_time 1.0"]);
  const ids = [
    { ...plain, configuration_id: "a" },
    { ...slowed, configuration_id: "b" },
  ];
  expect(configurationsOf([...ids, { configuration: "", configuration_id: "" }])).toEqual([
    { id: "a", words: "idm", runs: 1 },
    { id: "b", words: "idm · reaction_time 1.0", runs: 1 },
  ]);
});

const run = (agent: string, created_at: string, drivora = "1") => ({
  agent,
  agent_parameters: [],
  configuration: "",
  created_at,
  versions: { drivora, numpy: "2" },
});

it("runs are named by their ADS and as much of their time as tells them apart", () => {
  const when = (...runs: ReturnType<typeof run>[]) => runNames(runs).map((name) => name.when);
  const old = run("idm", "2026-11-26T03:03:05");
  expect(when(run("idm", "2026-11-27T03:02:55"), run("idm", "2026-11-27T03:03:05"))).toEqual([
    "03:02",
    "03:03",
  ]);
  expect(when(run("idm", "2026-11-27T03:03:05"), run("mobil", "2026-11-27T03:03:17"))).toEqual([
    "03:03:05",
    "03:03:17",
  ]);
  expect(when(old, run("idm", "2026-11-27T03:03:17"))).toEqual(["11-26", "11-27"]);
  expect(when(old, run("idm", "2026-11-27T03:03:17"), run("idm", "2026-11-27T04:03:17"))).toEqual([
    "11-26 03:03",
    "11-27 03:03",
    "11-27 04:03",
  ]);
});

it("the name of a run has the versions in which runs differ", () => {
  const names = runNames([
    run("idm", "2026-11-26T03:03:05"),
    run("mobil", "2026-11-27T03:03:05", "2"),
  ]);
  expect(names.map(({ whole }) => whole)).toEqual([
    "idm, drivora 1, 2026-11-26 03:03",
    "mobil, drivora 2, 2026-11-27 03:03",
  ]);
});

it("either of the two runs that are compared can be chosen; the old one is older", () => {
  const runs = ["a", "b", "c"].map((id) => ({ id }));
  expect(comparedRuns({ before: "", after: "" }, runs)).toEqual([1, 2]);
  expect(comparedRuns({ before: "a", after: "" }, runs)).toEqual([0, 2]);
  expect(comparedRuns({ before: "", after: "b" }, runs)).toEqual([0, 1]);
  expect(comparedRuns({ before: "c", after: "b" }, runs)).toEqual([0, 1]);
  expect(comparedRuns({ before: "gone", after: "a" }, runs)).toEqual([1, 2]);
  expect(comparedRuns({ before: "", after: "" }, [{ id: "a" }])).toEqual([-1, 0]);
});

it("labels that would touch are left out", () => {
  expect(labelStride(["03:03", "03:04"], 100)).toBe(1);
  expect(labelStride(["03:03", "03:04"], 20)).toBe(3);
});
