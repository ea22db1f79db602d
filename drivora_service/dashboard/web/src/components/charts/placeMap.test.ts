import { describe, expect, it } from "vitest";
import { boundsOf, linePath, planOf, shownBy, touches } from "./placeMap";

describe("plans of places", () => {
  it("keep the proportions, and point y up", () => {
    const { height, toX, toY } = planOf([0, 0, 100, 50], 224, 12);
    expect(height).toBe(112);
    expect(toX(50)).toBeCloseTo(112);
    expect(toY(0) - toY(10)).toBeCloseTo(toX(10) - toX(0));
    expect(toY(50)).toBeGreaterThanOrEqual(12);
  });
  it("lead back from pixels to places, and tell what they show", () => {
    const plan = planOf([0, 0, 100, 20], 200, 0);
    expect(plan.from(plan.toX(30), plan.toY(8))).toEqual([30, 8]);
    expect(plan.scale).toBe(2);
    expect(shownBy(plan, 200)).toEqual([0, -2.5, 100, 22.5]);
  });
  it("draw lines", () => {
    const plan = planOf([0, 0, 100, 50], 224, 12);
    expect(linePath([0, 0, 100, 50], plan)).toBe("M24.0,100.0L200.0,12.0");
  });
  it("are neither too low nor too high", () => {
    expect(planOf([0, 0, 1000, 10], 200).height).toBe(50);
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
