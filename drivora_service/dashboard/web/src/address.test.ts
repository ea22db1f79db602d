import { describe, expect, it } from "vitest";
import { firstOf, parseSearch, stringifySearch, valuesOf } from "./address";

describe("addresses", () => {
  it("keep repeated names in order, and signs that an address gives a meaning", () => {
    const search = { status: ["passed", "failed"], label: "a & b = c?", town: "Town 01" };
    expect(parseSearch(stringifySearch(search))).toEqual(search);
  });
  it("leave out what is empty", () => {
    expect(stringifySearch({ status: "", town: undefined })).toBe("");
  });
  it("tell values of a name", () => {
    expect(valuesOf(parseSearch("?a=1&a=2"), "a")).toEqual(["1", "2"]);
    expect(firstOf(parseSearch("?b=1"), "a")).toBe("");
  });
});
