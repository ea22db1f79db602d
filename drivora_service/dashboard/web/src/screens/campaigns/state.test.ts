import { expect, it } from "vitest";
import { actionsOf, lookOfSearch } from "./state";

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
