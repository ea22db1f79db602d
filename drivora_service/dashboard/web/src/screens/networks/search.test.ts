import { expect, it } from "vitest";
import type { Schemas } from "../../api/client";
import { extentOf, partsNamed } from "./search";

type Geometry = Schemas["NetworkGeometry"];

const LANE = {
  width: 3,
  drivable: true,
  walkable: false,
  internal: false,
  kind: "road",
  speed_limit: 13.9,
  left_marking: "none",
  right_marking: "none",
  index: 0,
} as const;
const GEOMETRY: Geometry = {
  name: "n",
  sha256: "",
  bounds: [0, 0, 100, 100],
  lanes: [
    {
      ...LANE,
      id: "mill_0",
      edge: "mill",
      street: "Mill Lane",
      shape: [
        [0, 0],
        [50, 0],
      ],
    },
    {
      ...LANE,
      id: "old_mill_0",
      edge: "old_mill",
      street: "",
      shape: [
        [0, 9],
        [50, 9],
      ],
    },
    { ...LANE, id: ":mill_w0", edge: ":mill_w0", street: "", internal: true, shape: [[0, 0]] },
  ],
  junctions: {
    mill: [
      [60, 0],
      [70, 0],
      [70, 10],
    ],
  },
  junction_types: { mill: "priority" },
  crossings: [],
  stop_lines: [],
  traffic_lights: [
    {
      id: "mill",
      position: [50, 0],
      program: "0",
      offset: 0,
      phases: [],
      links: [
        {
          index: 0,
          lane: "mill_0",
          to_lane: "x",
          direction: "s",
          stop_line: [
            [50, 2],
            [50, -2],
          ],
        },
        { index: 1, lane: ":mill_w0", to_lane: "c", direction: "s", stop_line: null },
      ],
    },
  ],
  signs: [],
};

it("parts are found by a piece of their name, exact names first", () => {
  const found = partsNamed(GEOMETRY, "Mill");
  expect(found.slice(0, 3).map(({ what }) => what)).toEqual(["traffic light", "junction", "edge"]);
  expect(found.map(({ id }) => id)).toContain("old_mill_0");
  expect(partsNamed(GEOMETRY, "harbour")).toEqual([]);
});
it("a light has the lanes before its stop lines, not those of walkers", () => {
  const { lanes, box } = extentOf(GEOMETRY, { what: "traffic light", id: "mill" });
  expect(lanes).toEqual(["mill_0"]);
  expect(box).toEqual([38, -14, 62, 14]);
});
