import { expect, it } from "vitest";
import {
  countedOracles,
  countingViolated,
  violatedAtFault,
  violatedBeside,
  withCounted,
} from "./counting";
import { type Draft, emptyDraft, withScenario } from "./draft";

const KNOWN = {
  definitions: {
    CampaignDocument: { properties: { oracles: { default: ["collision", "red_light"] } } },
  },
  oracles: ["collision", "failure_to_yield", "red_light"].map((name) => ({ name })) as never,
};

function draftOf(...violated: readonly string[]): Draft {
  const scenarios = withScenario([], { label: "a", origin: "of a run", document: {}, violated });
  return { ...emptyDraft("campaign"), scenarios };
}

it("what the run violated counts beside the default, in the order of the catalogue", () => {
  const draft = countingViolated(KNOWN, draftOf("failure_to_yield", "collision"));
  expect(draft.settings.oracles).toEqual(["collision", "failure_to_yield", "red_light"]);
  expect(violatedBeside(KNOWN, draft)).toEqual(["failure_to_yield"]);
});

it("a run that violated only what counts by default changes nothing", () => {
  const draft = draftOf("collision");
  expect(countingViolated(KNOWN, draft)).toBe(draft);
  expect(countedOracles(KNOWN, draft)).toEqual(["collision", "red_light"]);
});

it("what was taken back stays so when another scenario is added", () => {
  const before = draftOf("failure_to_yield");
  const other = { label: "b", origin: "a file", document: {} };
  const after = { ...before, scenarios: withScenario(before.scenarios, other) };
  expect(countingViolated(KNOWN, after, before)).toBe(after);
});

it("the default is not written into the document", () => {
  const draft = countingViolated(KNOWN, draftOf("failure_to_yield"));
  const back = withCounted(KNOWN, draft, ["red_light", "collision"]);
  expect(back.settings).not.toHaveProperty("oracles");
});

it("only violations at an ego's fault are of the run, and no observations", () => {
  const verdict = {
    oracle: "failure_to_yield",
    outcome: "violated",
    severity: "major",
    at_fault: true,
  } as const;
  const others = [
    { ...verdict, oracle: "collision", at_fault: false },
    { ...verdict, oracle: "destination", at_fault: null },
    { ...verdict, oracle: "law_52_priority", severity: "observation" },
    { ...verdict, oracle: "red_light", outcome: "passed" },
  ] as const;
  expect(violatedAtFault([verdict, ...others, verdict])).toEqual(["failure_to_yield"]);
});
