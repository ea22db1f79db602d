import { describe, expect, it } from "vitest";
import type { Schemas } from "../../../api/client";
import { planOf } from "../../../components/charts/placeMap";
import { LaneIndex } from "../../../roads/laneIndex";
import { drawingOf, laneNear } from "./roadDrawing";

function lane(id: string, y: number, width: number) {
  const shape = [
    [0, y],
    [100, y],
  ];
  return { id, shape, width, kind: "road", drivable: true } as unknown as Schemas["LaneGeometry"];
}

const INDEX = new LaneIndex([lane("a", 10, 3), lane("b", 20, 3), lane("far", 900, 3)]);
const PLAN = planOf([0, 0, 100, 25], 200, 0);
const shadeOf = (count: number) => (count > 0 ? count : undefined);

describe("the drawing of used roads", () => {
  it("has the unused lanes below, and one path for all pieces of a look", () => {
    const counted = new Map([
      ["a", { lane: "a", egos: [5, 0], actors: [5, 2] }],
      ["b", { lane: "b", egos: [0, 2], actors: [0, 5] }],
    ]);
    const drawn = drawingOf(INDEX, counted, "actors", shadeOf, PLAN, 200);
    expect(drawn.map(({ look, thick }) => [look, thick])).toEqual([
      ["unused", 2.4],
      ["use-2", 5.1],
      ["use-5", 5.1],
    ]);
    expect(drawn[0]?.path).toBe("M0.0,30.0L200.0,30.0M0.0,10.0L200.0,10.0");
    expect(drawn[2]?.path).toBe("M0.0,30.0L100.0,30.0M100.0,10.0L200.0,10.0");
  });
  it("tells the lane at a place or a little beside it, but not below the plan", () => {
    const id = (left: number, top: number) => laneNear(INDEX, PLAN, left, top)?.lane.id;
    expect([id(50, 30), id(50, 38), id(50, 12)]).toEqual(["a", "a", "b"]);
    expect(id(50, 46)).toBeUndefined();
    expect(id(50, 55)).toBeUndefined();
  });
});
