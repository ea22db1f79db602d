import { describe, expect, it } from "vitest";
import {
  documentOf,
  emptyDraft,
  labelled,
  nameOf,
  scenarioPointer,
  withRow,
  withScenario,
  withSetting,
} from "./draft";

const scenario = {
  ego_vehicles: [{ id: "a", agent: { name: "idm" } }, { id: "b" }],
  npc_walkers: [{ id: "w" }],
  map_region: { town: "tee-town" },
};
const named = (label: string) => ({ label, origin: "from a file", document: scenario });

describe("the document of a draft", () => {
  it("has one scenario, or several by their names, after what was chosen", () => {
    const empty = emptyDraft("campaign");
    const one = { ...empty, scenarios: withScenario([], named("left turn")) };
    expect(documentOf("campaign", one)).toEqual({
      name: "left turn, random",
      tester: { name: "random" },
      budget: { simulations: 200 },
      scenario,
    });
    expect(Object.keys(documentOf("campaign", one)).at(-1)).toBe("scenario");
    const two = { ...one, scenarios: withScenario(one.scenarios, named("left turn")) };
    expect(documentOf("campaign", two)).toMatchObject({
      name: "2 scenarios, random",
      scenarios: [
        { name: "left turn", scenario },
        { name: "left turn 2", scenario },
      ],
    });
    expect(documentOf("campaign", empty)).not.toHaveProperty("scenario");
  });
  it("of a study labels its scenarios, and keeps the space of one", () => {
    const draft = emptyDraft("study");
    const scenarios = withScenario([], { ...named("left turn"), space: { vehicles: 1 } });
    const document = documentOf("study", withSetting({ ...draft, scenarios }, "/agents", []));
    expect(document.scenarios).toEqual([
      { label: "left turn", space: { vehicles: 1 }, document: scenario },
    ]);
    expect(document).not.toHaveProperty("agents");
    expect(document.methods).toEqual([{ name: "random" }]);
  });
  it("leaves out what was set back", () => {
    const draft = withSetting(emptyDraft("campaign"), "/space/vehicles", 5);
    expect(documentOf("campaign", draft).space).toEqual({ vehicles: 5 });
    const back = withSetting(draft, "/space/vehicles", undefined);
    expect(documentOf("campaign", back)).not.toHaveProperty("space");
  });
});

it("a typed name stays, though the method changes", () => {
  const draft = withSetting(emptyDraft("campaign"), "/name", "nightly");
  expect(nameOf("campaign", withSetting(draft, "/tester/name", "avfuzzer"))).toBe("nightly");
  expect(nameOf("campaign", withSetting(draft, "/name", undefined))).toBe("campaign, random");
});

it("a method that is added again has a label of its own", () => {
  const once = withRow([], "avfuzzer");
  expect(once).toEqual([{ name: "avfuzzer" }]);
  const twice = withRow(once, "avfuzzer");
  expect(twice.at(-1)).toEqual({ name: "avfuzzer", label: "avfuzzer 2" });
  expect(withRow(twice, "avfuzzer").at(-1)).toEqual({ name: "avfuzzer", label: "avfuzzer 3" });
});

it("labels are on one line and short", () => {
  expect(labelled("  a\n\tb\u0000 ")).toBe("a b");
  expect(labelled("x".repeat(150))).toHaveLength(100);
});

it("a place of a scenario depends on their number", () => {
  expect(scenarioPointer("campaign", 1, 0)).toBe("/scenario");
  expect(scenarioPointer("campaign", 2, 0)).toBe("/scenarios/0");
  expect(scenarioPointer("study", 1, 0)).toBe("/scenarios/0");
});
