import { expect, it } from "vitest";
import type { Schemas } from "../../api/client";
import { onWayFirst } from "./nearness";
import { placesOf } from "./places";
import { actorsOf, emptyScenario, type NewPlace } from "./scenario";
import { withDrive, withWalk } from "./situations";

type Lane = Schemas["LaneGeometry"];

const lane = (id: string, shape: [number, number][], more: Partial<Lane> = {}): Lane => ({
  id,
  shape,
  width: 3.2,
  drivable: true,
  walkable: false,
  internal: false,
  kind: "road",
  edge: id.slice(0, id.lastIndexOf("_")),
  index: Number(id.slice(id.lastIndexOf("_") + 1)),
  street: "",
  speed_limit: 14,
  left_marking: "solid",
  right_marking: "solid",
  ...more,
});
const movement = (to_edge: string, direction: string, right_of_way: string, link = -1) => ({
  to_edge,
  via: [":j_0_0"],
  direction,
  right_of_way,
  link,
});

/** From the west into a junction at (100, 0), to the north by two lanes. */
const GEOMETRY: Schemas["NetworkGeometry"] = {
  name: "corner",
  sha256: "",
  bounds: [0, 0, 120, 120],
  lanes: [
    lane(
      "in_0",
      [
        [0, 0],
        [100, 0],
      ],
      { street: "Mill Road" },
    ),
    lane(
      ":j_0_0",
      [
        [100, 0],
        [110, 10],
      ],
      { kind: "junction", internal: true },
    ),
    lane(
      "out_0",
      [
        [114, 10],
        [114, 120],
      ],
      { street: "High Street" },
    ),
    lane(
      "out_1",
      [
        [110, 10],
        [110, 120],
      ],
      { street: "High Street" },
    ),
    lane(
      ":j_c0_0",
      [
        [104, 12],
        [120, 12],
      ],
      { kind: "crossing", drivable: false },
    ),
  ],
  junctions: {
    j: [
      [100, -5],
      [120, -5],
      [120, 10],
      [100, 10],
    ],
    node: [[0, 0]],
  },
  junction_types: { j: "priority", node: "priority" },
  crossings: [
    {
      id: ":j_c0_0",
      junction: "j",
      shape: [
        [104, 12],
        [120, 12],
      ],
      width: 4,
      outline: [],
      edges: ["out"],
      light: "",
      links: [],
    },
  ],
  stop_lines: [
    {
      lane: "in_0",
      junction: "j",
      points: [
        [100, 2],
        [100, -2],
      ],
      control: "yield",
      light: "",
      movements: [movement("out", "l", "m"), movement("out", "r", "M")],
    },
  ] as unknown as Schemas["NetworkGeometry"]["stop_lines"],
  traffic_lights: [],
  signs: [],
};
const write = ({ x, y }: { x: number; y: number }): NewPlace => ({ x, y });

it("turns are found with the lane that they lead to", () => {
  const [turn, ...others] = placesOf(GEOMETRY, "left turn that gives way");
  expect(others).toEqual([]);
  expect(turn?.name).toBe("Mill Road to High Street, from the west");
  // The way goes on where the lane of the junction ends, not in the first lane of the road.
  expect(turn?.lanes).toEqual(["in_0", ":j_0_0", "out_1"]);
  expect(turn?.drive).toMatchObject([
    { x: expect.closeTo(55), y: 0, lane: "in_0" },
    { x: 110, y: expect.closeTo(55), lane: "out_1" },
  ]);
  expect(placesOf(GEOMETRY, "right turn")).toHaveLength(1);
  expect(placesOf(GEOMETRY, "left turn with its own green")).toEqual([]);
});

it("crossings are told apart by their street and arm, those on a way come first", () => {
  const [crossing] = placesOf(GEOMETRY, "crossing");
  if (!crossing) throw new Error("there is a crossing");
  expect(crossing.name).toBe("High Street, north of j");
  const other = { ...crossing, id: "other", line: [300, 0, 310, 0] };
  const way = [112, -50, 112, 100];
  expect(onWayFirst([other, crossing], [way])).toEqual([
    { place: crossing, isOnWay: true },
    { place: other, isOnWay: false },
  ]);
});

it("a signal tells turns that give way from those that have their own green", () => {
  const phases = (states: string[]) => states.map((state) => ({ duration: 10, state }));
  const signalled = (states: string[]): Schemas["NetworkGeometry"] => ({
    ...GEOMETRY,
    stop_lines: GEOMETRY.stop_lines.map((line) => ({
      ...line,
      light: "j",
      movements: [movement("out", "l", "m", 0)],
    })),
    traffic_lights: [
      { id: "j", position: [0, 0], links: [], program: "0", offset: 0, phases: phases(states) },
    ],
  });
  expect(placesOf(signalled(["g", "r"]), "left turn that gives way")).toHaveLength(1);
  expect(placesOf(signalled(["G", "r"]), "left turn that gives way")).toEqual([]);
  expect(placesOf(signalled(["G", "r"]), "left turn with its own green")).toHaveLength(1);
});

it("an ego is sent through a turn, and a walker across", () => {
  const [turn] = placesOf(GEOMETRY, "left turn that gives way");
  const [crossing] = placesOf(GEOMETRY, "crossing");
  if (!turn || !crossing) throw new Error("there is a turn and a crossing");
  const [driven, ego] = withDrive(emptyScenario("corner"), turn, write) ?? [];
  expect(ego).toBe("/ego_vehicles/0");
  const [crossed, walker] = (driven && withWalk(driven, crossing, write)) ?? [];
  expect(walker).toBe("/npc_walkers/0");
  expect(actorsOf(crossed ?? {}).at(1)?.places).toMatchObject([
    { x: 102.5, y: 12 },
    { x: 121.5, y: 12 },
  ]);
  // The only ego is sent elsewhere instead of being joined by another.
  const [again] = withDrive(crossed ?? {}, turn, write) ?? [];
  expect(actorsOf(again ?? {}).map(({ id }) => id)).toEqual(["ego", "walker"]);
});

it("nodes without arms are no junctions, roads of one lane not of several", () => {
  expect(placesOf(GEOMETRY, "junction with lights")).toEqual([]);
  expect(placesOf(GEOMETRY, "road of several lanes").map(({ name }) => name)).toEqual([
    "High Street, 2 lanes, 110 m",
  ]);
});
