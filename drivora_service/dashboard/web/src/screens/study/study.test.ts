import { describe, expect, it } from "vitest";
import type { Schemas } from "../../api/client";
import { axesOf, canCompare, cellsOf, keyOf } from "./cells";
import { differing, flatten } from "./flatten";

function campaign(method: string, simulations: number, avoidable: number | null, repetition = 1) {
  return {
    id: `${method}${repetition}`,
    simulations,
    counts: { violating: 5, avoidable },
    cell: { scenario: "left turn", agent: "idm", method, repetition },
  } as Schemas["CampaignSummary"];
}

describe("cells of a study", () => {
  it("add up their repetitions", () => {
    const cells = cellsOf([campaign("random", 20, 1), campaign("random", 10, 2, 2)]);
    const cell = cells.get(keyOf("left turn", "idm", "random"));
    expect(cell).toMatchObject({ simulations: 30, failing: 10, avoidable: 3 });
    expect(cell?.campaigns).toHaveLength(2);
  });
  it("do not count what one repetition did not record", () => {
    const cells = cellsOf([campaign("random", 20, 1), campaign("random", 10, null, 2)]);
    expect(cells.get(keyOf("left turn", "idm", "random"))?.avoidable).toBeNull();
  });
  it("keep the order of the campaigns", () => {
    const { methods } = axesOf(cellsOf([campaign("random", 1, 0), campaign("avfuzzer", 1, 0)]));
    expect(methods).toEqual(["random", "avfuzzer"]);
  });
});

describe("methods of a study", () => {
  const usual = { method: "", agent: "" };
  const finished = (method: string, agent = "idm", repetitions = 2) =>
    Array.from({ length: repetitions }, (_, repetition) => ({
      ...campaign(method, 10, 0, repetition),
      state: "finished" as const,
      cell: { scenario: "left turn", agent, method, repetition },
    }));
  it("are compared once two repetitions of two of them have finished", () => {
    const one = [...finished("random"), ...finished("avfuzzer", "idm", 1)];
    expect(canCompare(cellsOf(one), usual)).toBe(false);
    const two = cellsOf([...finished("random"), ...finished("avfuzzer")]);
    expect(canCompare(two, usual)).toBe(true);
    expect(canCompare(two, { method: "samota", agent: "" })).toBe(false);
  });
  it("are compared with the baseline alone, and ADSs by the same method", () => {
    const others = [...finished("avfuzzer"), ...finished("samota"), campaign("random", 10, 0)];
    expect(canCompare(cellsOf(others), usual)).toBe(false);
    expect(canCompare(cellsOf(others), { ...usual, method: "samota" })).toBe(true);
    const agents = cellsOf([...finished("random", "idm"), ...finished("random", "nmpc")]);
    expect(canCompare(agents, usual)).toBe(true);
  });
});

describe("settings", () => {
  it("are the leaves of a document by their paths", () => {
    const document = { space: { vehicles: 4, parts: ["a", "b"] }, egos: [{}, {}], seed: null };
    expect([...flatten(document)]).toEqual([
      ["space.vehicles", "4"],
      ["space.parts", "a, b"],
      ["egos", "2"],
    ]);
  });
  it("are shown only where they differ, also where one has none", () => {
    const documents = [
      { name: "random", population: 4 },
      { name: "avfuzzer", population: 4, crossover: 0.5 },
    ];
    expect(differing(documents)).toEqual([
      { path: "name", values: ["random", "avfuzzer"] },
      { path: "crossover", values: ["", "0.5"] },
    ]);
  });
});
