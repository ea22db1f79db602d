import { describe, expect, it } from "vitest";
import { documentOf } from "./draft";
import { draftOf, spaceStandards } from "./stored";

const scenario = {
  ego_vehicles: [{ id: "a", agent: { name: "idm" } }, { id: "b" }],
  npc_walkers: [{ id: "w" }],
  map_region: { town: "tee-town" },
};
const reference = (name: string) => ({ $ref: `#/components/schemas/${name}` });
const definitions = {
  CampaignDocument: {
    properties: {
      tester: reference("TesterDocument"),
      space: reference("SpaceDocument"),
      oracles: { default: ["collision"] },
      seed: { default: 0 },
      workers: { default: null },
    },
  },
  StudyDocument: {
    properties: {
      methods: { items: reference("TesterDocument") },
      space: reference("SpaceDocument"),
      seed: { default: 1 },
    },
  },
  TesterDocument: { properties: { name: {}, parameters: {}, feedback: { default: "own" } } },
  SpaceDocument: {
    properties: { preset: { default: null }, vehicles: { default: 3 }, walkers: { default: 1 } },
  },
};
const presets = new Map([["avfuzzer", { vehicles: 2, walkers: 0 }]]);

describe("the draft of a stored document", () => {
  const options = { definitions, presets, label: "tee-town" };
  it("has no defaults, and posts the same campaign", () => {
    const stored = {
      version: "1.0",
      name: "first",
      tester: { name: "random", parameters: {}, feedback: "own" },
      scenario,
      space: { vehicles: 4, walkers: 1 },
      budget: { simulations: 12 },
      oracles: ["collision"],
      seed: 3,
      workers: null,
    };
    const draft = draftOf("campaign", stored, options);
    expect(draft.settings).toEqual({
      name: "first",
      tester: { name: "random" },
      space: { vehicles: 4 },
      budget: { simulations: 12 },
      seed: 3,
    });
    expect(draft.scenarios.map(({ label }) => label)).toEqual(["tee-town"]);
    expect(documentOf("campaign", draft).scenario).toBe(scenario);
  });
  it("keeps a named space with the values that differ from it", () => {
    const space = { preset: "avfuzzer", vehicles: 3, walkers: 0 };
    expect(draftOf("campaign", { space }, options).settings.space).toEqual({
      preset: "avfuzzer",
      vehicles: 3,
    });
    expect(spaceStandards("avfuzzer", definitions, presets)).toEqual({ vehicles: 2, walkers: 0 });
    expect(spaceStandards(undefined, definitions, presets)).toEqual({ vehicles: 3, walkers: 1 });
  });
  it("of a study has its methods and the spaces of its scenarios", () => {
    const stored = {
      scenarios: [{ document: scenario, space: { vehicles: 3, walkers: 2 } }],
      agents: [],
      methods: [{ name: "avfuzzer", parameters: { population: 4 }, feedback: "own" }],
      seed: 1,
    };
    const draft = draftOf("study", stored, options);
    expect(draft.settings).toEqual({
      methods: [{ name: "avfuzzer", parameters: { population: 4 } }],
    });
    expect(draft.scenarios).toMatchObject([{ label: "tee-town", space: { walkers: 2 } }]);
  });
});
