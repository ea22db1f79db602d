import { describe, expect, it } from "vitest";
import {
  cameraOf,
  cameraText,
  readCamera,
  scaleBar,
  toScreen,
  toWorld,
  withSight,
  zoomAt,
} from "./camera";

const SIZE = { width: 800, height: 400 };

describe("a camera", () => {
  it("fits a box with its margin", () => {
    const camera = cameraOf([0, 0, 200, 50], SIZE, 0);
    expect(camera).toEqual({ x: 100, y: 25, scale: 4 });
    expect(toScreen(camera, SIZE, 0, 25)).toEqual([0, 200]);
  });
  it("has north above", () => {
    const camera = cameraOf([0, 0, 200, 50], SIZE, 0);
    expect(toScreen(camera, SIZE, 100, 50)[1]).toBeLessThan(200);
  });
  it("keeps the place under the pointer when it comes nearer", () => {
    const before = { x: 10, y: 20, scale: 3 };
    const place = toWorld(before, SIZE, 700, 30);
    const after = zoomAt(before, SIZE, 700, 30, 2.5);
    const again = toWorld(after, SIZE, 700, 30);
    expect(again[0]).toBeCloseTo(place[0], 9);
    expect(again[1]).toBeCloseTo(place[1], 9);
    expect(after.scale).toBe(7.5);
  });
  it("is written to an address and read from it", () => {
    expect(readCamera(cameraText({ x: -12.34, y: 5, scale: 6.4 }))).toEqual({
      x: -12.3,
      y: 5,
      scale: 6.4,
    });
    for (const wrong of ["", "1,2", "a,b,c", "1,2,0"]) expect(readCamera(wrong)).toBeUndefined();
  });
  it("is moved only as far as places come into sight", () => {
    const camera = { x: 0, y: 0, scale: 4 };
    expect(withSight(camera, SIZE, [[80, -30]])).toBe(camera);
    expect(withSight(camera, SIZE, [[100, 0]])).toEqual({ x: 10, y: 0, scale: 4 });
    expect(withSight(camera, SIZE, [[0, -45]])).toEqual({ x: 0, y: -5, scale: 4 });
    expect(withSight(camera, SIZE, [[300, -60]])).toEqual({ x: 300, y: -60, scale: 4 });
    // Places that do not fit together: the last one is seen.
    expect(
      withSight(camera, SIZE, [
        [500, 0],
        [0, 0],
      ]).x,
    ).toBe(90);
  });
  it("has a round scale bar no longer than 110 pixels", () => {
    expect(scaleBar(1)).toBe(100);
    expect(scaleBar(3)).toBe(20);
    expect(scaleBar(40)).toBe(2);
  });
});
