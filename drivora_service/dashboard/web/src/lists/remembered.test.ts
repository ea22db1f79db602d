import { describe, expect, it } from "vitest";
import { chosenIds } from "./columns";
import { readViews, sameSearch } from "./views";

describe("what a browser remembers", () => {
  it("is columns in the list's order, without those that it does not have any more", () => {
    expect(chosenIds(["town", "gone", "id"], ["id", "town", "agent"], ["id"])).toEqual([
      "id",
      "town",
    ]);
  });
  it("gives the usual columns where nothing useful is stored", () => {
    expect(chosenIds(undefined, ["id"], ["id"])).toEqual(["id"]);
    expect(chosenIds({ a: 1 }, ["id"], ["id"])).toEqual(["id"]);
    expect(chosenIds(["gone"], ["id"], ["id"])).toEqual(["id"]);
  });
  it("is views, and nothing else", () => {
    expect(readViews([{ name: "a", search: "?x=1" }, { name: 3 }, null])).toEqual([
      { name: "a", search: "?x=1" },
    ]);
  });
  it("tells equal views in any order of their parts", () => {
    expect(sameSearch({ a: "1", b: ["2", "3"] }, { b: ["3", "2"], a: ["1"] })).toBe(true);
    expect(sameSearch({ a: "1" }, { a: "1", b: "" })).toBe(true);
    expect(sameSearch({ a: "1" }, { a: "2" })).toBe(false);
  });
});
