import { expect, it } from "vitest";
import { planeOf, toDocument, toMap, yawToMap } from "./plane";

it("the network's frame is the plane of the map", () => {
  const plane = planeOf("sumo", [100, 200]);
  expect(toMap(plane, { x: 3, y: 4 })).toEqual([3, 4]);
  expect(yawToMap(plane, 90)).toBeCloseTo(Math.PI / 2);
  expect(toDocument(plane, 3.004, 4.006, Math.PI)).toEqual({ x: 3, y: 4.01, yaw: 180 });
});

it("CARLA's frame is mirrored and moved by the network's offset", () => {
  const plane = planeOf("carla", [100, 200]);
  expect(toMap(plane, { x: 3, y: 4 })).toEqual([103, 196]);
  expect(yawToMap(plane, 90)).toBeCloseTo(-Math.PI / 2);
  for (const [x, y, yaw] of [
    [103, 196, 0.5],
    [0, 200, -1],
  ] as const) {
    const place = toDocument(plane, x, y, yaw);
    expect(toMap(plane, place)).toEqual([x, y]);
    expect(yawToMap(plane, place.yaw ?? 0)).toBeCloseTo(yaw, 2);
  }
});

it("no number is minus zero, which is written differently", () => {
  const { x, y, yaw } = toDocument(planeOf("carla", [0, 0]), -0.001, 0.001, -0.0001);
  expect([x, y, yaw].map((value) => Object.is(value, -0))).toEqual([false, false, false]);
});
