import { expect, it } from "vitest";
import { countedOracles, countingAsDefined, type Defined, withCounted } from "./counting";
import { type Draft, emptyDraft, withScenario } from "./draft";

const KNOWN = {
  oracles: [
    { name: "collision", severity: "major" },
    { name: "near_miss", severity: "observation" },
    { name: "red_light", severity: "major" },
  ] as never,
};

function draftOf(definition?: Defined): Draft {
  const scenarios = withScenario([], { label: "a", origin: "of a run", document: {}, definition });
  return { ...emptyDraft("campaign"), scenarios };
}

it("all oracles but observations count where a document names none", () => {
  expect(countedOracles(KNOWN, draftOf())).toEqual(["collision", "red_light"]);
});

it("a search from a run counts what was defined for the run", () => {
  const draft = countingAsDefined(draftOf({ counts: "any", oracles: ["near_miss"] }));
  expect(draft.settings).toMatchObject({ counts: "any", oracles: ["near_miss"] });
  expect(countedOracles(KNOWN, draft)).toEqual(["near_miss"]);
});

it("the default of a run is not written into the document", () => {
  const draft = draftOf({ counts: "accountable", oracles: null });
  expect(countingAsDefined(draft).settings).toEqual(draft.settings);
});

it("what the draft says itself stays when another scenario is added", () => {
  const own = { ...draftOf({ counts: "any", oracles: null }), settings: { counts: "at_fault" } };
  expect(countingAsDefined(own)).toBe(own);
});

it("the default is not written where it is chosen by hand", () => {
  const draft = withCounted(KNOWN, draftOf(), ["near_miss"]);
  expect(draft.settings.oracles).toEqual(["near_miss"]);
  const back = withCounted(KNOWN, draft, ["red_light", "collision"]);
  expect(back.settings).not.toHaveProperty("oracles");
});
