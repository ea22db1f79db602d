import { describe, expect, it } from "vitest";
import {
  answerOf,
  documentText,
  lookOfMinimization,
  mayBeCancelled,
  minimizationOf,
  minimizeCommand,
  type Size,
  type Summary,
  sizeRows,
  sizeWords,
  stageWords,
  tookWords,
} from "./minimization";

const BEFORE: Size = {
  actors: 1203,
  egos: 1,
  vehicles: 2,
  walkers: 0,
  obstacles: 0,
  background: 1200,
  waypoints: 34,
  settings: 0,
  route_m: 118.04,
  sim_time_s: 20,
  digits: 342,
  patches: 0,
};
const AFTER: Size = { ...BEFORE, actors: 1, vehicles: 0, background: 0, waypoints: 4, route_m: 27 };

const minimization = (part: Partial<Summary>) =>
  ({
    id: "01a215ff5460f2a66a7526da",
    run_id: "01a215fd4807bba88c0ac5f4-22",
    state: "finished",
    message: "",
    failure: { oracle: "red_light", ego: "ego_1", radius_m: 10 },
    budget: 500,
    before: BEFORE,
    after: AFTER,
    one_minimal: true,
    started_at: "2026-03-02T09:30:01Z",
    ended_at: "2026-03-02T09:31:21Z",
    ...part,
  }) as Summary;

describe("a minimisation", () => {
  it("tells what is left, and whether every reduction was tried", () => {
    expect(answerOf(minimization({}))).toBe(
      "1 of 1,203 actors and 4 of 34 waypoints are left; every single reduction was tried.",
    );
    expect(answerOf(minimization({ one_minimal: false }))).toMatch(/the budget ended before/);
  });
  it("claims nothing before the failure was reproduced", () => {
    const none = { before: null, after: null, one_minimal: null };
    expect(answerOf(minimization({ ...none, state: "running" }))).not.toMatch(/left/);
    expect(answerOf(minimization({ ...none, state: "cancelled" }))).toMatch(/ended before/);
  });
  it("says in the service's words why it failed", () => {
    const message = "the smallest scenario did not fail again";
    expect(answerOf(minimization({ state: "failed", message }))).toBe(
      "The smallest scenario did not fail again.",
    );
  });
  it("is no success where the budget ended first", () => {
    expect(lookOfMinimization(minimization({})).tone).toBe("good");
    expect(lookOfMinimization(minimization({ one_minimal: false })).tone).toBe("lost");
    expect(lookOfMinimization(minimization({ state: "failed" })).text).toBe("failed");
  });
  it("can be cancelled as long as it could go on", () => {
    const states = ["queued", "running", "interrupted", "finished", "failed", "cancelled"] as const;
    expect(states.filter((state) => mayBeCancelled({ state }))).toEqual([
      "queued",
      "running",
      "interrupted",
    ]);
  });
  it("tells how long it took once it has ended", () => {
    expect(tookWords(minimization({}))).toBe("1 min 20 s");
    expect(tookWords(minimization({ ended_at: null }))).toBe("");
  });
  it("has a command that asks for the same", () => {
    expect(minimizeCommand(minimization({}), "http://localhost:8000")).toBe(
      "drivora minimize 01a215fd4807bba88c0ac5f4-22 --oracle red_light --radius 10 --budget 500 " +
        "--server http://localhost:8000 --out smaller",
    );
  });
  it("shows a stage that the page does not know by its name", () => {
    expect(stageWords("proof")).toBe("trying every single reduction");
    expect(stageWords("not_reproduced")).toBe("not reproduced");
  });
});

describe("the sizes", () => {
  const rows = sizeRows(BEFORE, AFTER);
  const of = (name: string) => rows.find((row) => row.name === name);
  it("leave out kinds of actors that the scenario never had, and nothing else", () => {
    expect(rows.map(({ name }) => name)).toEqual([
      "actors",
      "egos",
      "NPC vehicles",
      "background traffic",
      "waypoints",
      "settings",
      "digits of numbers",
      "routes of egos",
      "simulated time",
    ]);
    expect(rows.filter(({ isPart }) => isPart)).toHaveLength(3);
  });
  it("have their unit, digits, and the share that is left", () => {
    expect(of("routes of egos")).toMatchObject({ unit: "m", before: "118.0", after: "27.0" });
    expect(of("background traffic")).toMatchObject({ before: "1,200", after: "0", share: 0 });
    expect(of("digits of numbers")?.share).toBe(1);
    expect(of("settings")?.share).toBe(0);
  });
  it("fit on a line", () => {
    expect(sizeWords(AFTER)).toBe("1 actor, 4 waypoints, 27 m of routes, 20.0 s");
  });
});

it("a document is shown as it is, with each list of plain values on one line", () => {
  const document = {
    trajectory: [
      [0.25, -413.75],
      [0.5, 416.5],
    ],
    names: ["a [b", "c]  d, {e}", 'f "g'],
    empty: [],
    route: [{ x: 1 }],
  };
  const text = documentText(document);
  expect(JSON.parse(text)).toEqual(document);
  expect(text).toContain("    [0.25, -413.75],\n    [0.5, 416.5]\n");
});

it("a run of a minimisation leads to it, and no other run does", () => {
  const id = "01a215ff5460f2a66a7526da";
  expect(minimizationOf(`${id}-81f16c3e97bd4fr`)).toBe(id);
  expect(minimizationOf(id)).toBe("");
  expect(minimizationOf(`${id}-22-again`)).toBe("");
});
