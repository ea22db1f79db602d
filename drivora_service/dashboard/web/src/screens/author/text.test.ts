import { expect, it } from "vitest";
import type { JsonObject } from "../../components/fields/pointers";
import { readText, TextPlaces, writeText } from "./text";

const SCENARIO: JsonObject = {
  version: "1.0",
  map_region: { town: "tee-town" },
  ego_vehicles: [
    {
      id: "ego",
      route: [
        { x: 1.5, y: 2 },
        { x: 30, y: 2, yaw: 90 },
      ],
      agent: { name: "idm", parameters: {} },
      reference_path: [],
    },
  ],
  seed: 1,
};

it("a document is the same after being written and read, in both languages", () => {
  for (const language of ["json", "yaml"] as const) {
    const text = writeText(SCENARIO, language);
    expect(readText(text, language)).toEqual({ document: SCENARIO });
  }
});

it("JSON is what the browser reads, and a place stands in one line", () => {
  const text = writeText(SCENARIO, "json");
  expect(JSON.parse(text)).toEqual(SCENARIO);
  expect(text).toContain('{ "x": 30, "y": 2, "yaw": 90 }');
});

it("YAML has a place in one line, too, and its version is text", () => {
  const text = writeText(SCENARIO, "yaml");
  expect(text).toContain("- {x: 30, y: 2, yaw: 90}");
  expect(text).toContain('version: "1.0"');
});

it("what cannot be read is told with its place", () => {
  const json = readText('{\n  "seed": 1,\n}', "json");
  expect(json).toMatchObject({ error: expect.stringContaining("no JSON") });
  expect("error" in json && json.from).toBeGreaterThan(5);
  const yaml = readText("seed: 1\nweather: [1,\n", "yaml");
  expect(yaml).toMatchObject({ error: expect.stringContaining("no YAML") });
  expect(readText("[1]", "json")).toMatchObject({ error: expect.stringContaining("object") });
  expect(readText("", "yaml")).toMatchObject({ error: expect.stringContaining("object") });
});

it("aliases, which the service refuses, are not read", () => {
  expect(readText("a: &x [1, 2]\nb: *x\n", "yaml")).toMatchObject({
    error: expect.stringContaining("no YAML"),
  });
});

it("a part of the document is found in its text", () => {
  for (const language of ["json", "yaml"] as const) {
    const text = writeText(SCENARIO, language);
    const places = new TextPlaces(text);
    const { from, to } = places.rangeOf("/ego_vehicles/0/route/1/yaw");
    expect(text.slice(from, to)).toBe("90");
    const town = places.rangeOf("/map_region/town");
    expect(text.slice(town.from, town.to)).toMatch(/^"?tee-town"?$/);
    // What is missing is told at what is around it.
    expect(places.rangeOf("/map_region/region_segment/min_x")).toEqual(
      places.rangeOf("/map_region"),
    );
  }
});
