import { expect, it } from "vitest";
import { LaneIndex } from "./laneIndex";

function lane(id: string, shape: number[][], kind: "road" | "walking_area" = "road") {
  return {
    id,
    shape,
    width: 3,
    drivable: kind === "road",
    walkable: kind !== "road",
    internal: false,
    kind,
    edge: id,
    index: 0,
    street: "",
    speed_limit: 13.9,
    left_marking: "none",
    right_marking: "none",
  } as const;
}

const LANES = new LaneIndex([
  lane("a", [
    [0, 0],
    [300, 0],
  ]),
  lane("b", [
    [0, 3],
    [300, 3],
  ]),
  lane(
    "w",
    [
      [400, 0],
      [410, 0],
      [410, 10],
      [400, 10],
    ],
    "walking_area",
  ),
]);

it("the lane under a place is found far from its points, with offset and side", () => {
  const found = LANES.at(140, 0.5);
  expect(found?.lane.id).toBe("a");
  expect(found?.offset).toBe(140);
  expect(found?.lateral).toBe(0.5);
  expect(LANES.at(140, 2.2)?.lane.id).toBe("b");
});
it("a walking area is found by its outline", () => {
  expect(LANES.at(404, 4)?.lane.id).toBe("w");
});
it("there is none beside the road", () => {
  expect(LANES.at(140, 20)).toBeUndefined();
});
