import { describe, expect, it } from "vitest";
import { boundsOf, planOf, touches } from "./placeMap";

describe("plans of places", () => {
  it("keep the proportions, and point y up", () => {
    const { height, toX, toY } = planOf([0, 0, 100, 50], 224, 12);
    expect(height).toBe(112);
    expect(toX(50)).toBeCloseTo(112);
    expect(toY(0) - toY(10)).toBeCloseTo(toX(10) - toX(0));
    expect(toY(50)).toBeGreaterThanOrEqual(12);
  });
  it("are neither too low nor too high", () => {
    expect(planOf([0, 0, 1000, 10], 200).height).toBe(70);
    expect(planOf([0, 0, 10, 1000], 200).height).toBe(120);
  });
  it("surround points with room", () => {
    expect(
      boundsOf(
        [
          [3, 4],
          [1, 8],
        ],
        10,
      ),
    ).toEqual([-9, -6, 13, 18]);
    expect(boundsOf([], 10)).toBeUndefined();
  });
  it("leave out lines that are elsewhere", () => {
    const line = [
      [0, 0],
      [10, 0],
    ];
    expect(touches(line, [5, -1, 6, 1])).toBe(true);
    expect(touches(line, [11, -1, 12, 1])).toBe(false);
  });
});
