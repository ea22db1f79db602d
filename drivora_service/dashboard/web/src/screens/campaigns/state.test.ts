import { expect, it } from "vitest";
import { actionsOf, lookOfSearch, shortName } from "./state";

it("offers what the state allows", () => {
  expect(actionsOf("running", "")).toEqual(["pause", "cancel"]);
  expect(actionsOf("running", "pause")).toEqual(["cancel"]);
  expect(actionsOf("running", "cancel")).toEqual([]);
  expect(actionsOf("interrupted", "")).toEqual(["resume", "cancel"]);
  expect(actionsOf("finished", "")).toEqual([]);
});
it("says what will happen to a running one", () => {
  expect(lookOfSearch("running", "pause").text).toBe("running, will pause");
});
it("names a campaign of a study by its repetition, and others as they are", () => {
  const cell = { scenario: "left turn", agent: "idm", method: "random", repetition: 2 };
  expect(shortName("nightly, left turn, idm, random, 2", cell)).toBe("nightly · 2");
  expect(shortName("renamed", cell)).toBe("renamed");
  expect(shortName("nightly, left turn, idm, random, 2", null)).toContain("left turn");
});
