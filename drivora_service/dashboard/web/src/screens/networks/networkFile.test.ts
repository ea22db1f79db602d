import { describe, expect, it } from "vitest";
import { formatOf, isNetworkName, proposedName } from "./networkFile";

describe("the format of a file", () => {
  it.each([
    ["town.net.xml", "sumo"],
    ["Town01.XODR", "opendrive"],
    ["district.osm", "openstreetmap"],
    ["district.osm.xml", "openstreetmap"],
    ["town.xml", undefined],
    ["town.zip", undefined],
  ])("of %s is %s", (file, format) => {
    expect(formatOf(file)).toBe(format);
  });
});

describe("the proposed name", () => {
  it.each([
    ["old-town.net.xml", "old-town"],
    ["Town01.xodr", "Town01"],
    ["district.osm.xml", "district"],
    ["Münchner Straße (2).osm", "Munchner-Stra-e-2"],
    ["map.v2.xodr", "map-v2"],
    ["town.xml", "town"],
    ["../../etc.net.xml", "etc"],
    ["東京.osm", ""],
    [`${"x".repeat(80)}.osm`, "x".repeat(64)],
  ])("for %s is %s", (file, name) => {
    expect(proposedName(file)).toBe(name);
    expect(isNetworkName(name)).toBe(name !== "");
  });
});
