import { describe, expect, it } from "vitest";
import { bandPath, bestSoFar, boxOf, paretoFront, stepPath, survival, valueAt } from "./curves";
import { linear, rounded, spread, ticks, wholeTicks } from "./scale";

const same = (value: number) => value;

describe("scales", () => {
  it("map ends to ends, and an empty range to the middle", () => {
    const scale = linear(10, 20, 100, 0);
    expect([scale(10), scale(20), scale(15)]).toEqual([100, 0, 50]);
    expect(linear(3, 3, 0, 10)(3)).toBe(5);
  });
  it("have round ticks", () => {
    expect(ticks(0, 60)).toEqual([0, 10, 20, 30, 40, 50, 60]);
    expect(ticks(0.07, 0.31)).toEqual([0.1, 0.15, 0.2, 0.25, 0.3]);
    expect(ticks(-1, 1, 4)).toEqual([-1, -0.5, 0, 0.5, 1]);
    expect(ticks(5, 5)).toEqual([5]);
  });
  it("have whole ticks for counts", () => {
    expect(wholeTicks(0, 2)).toEqual([0, 1, 2]);
    expect(wholeTicks(0, 1)).toEqual([0, 1]);
  });
  it("have round ends that hold all values", () => {
    expect(rounded([0.13, 0.47])).toEqual([0.1, 0.5]);
    expect(rounded([])).toEqual([0, 1]);
    expect(rounded([4, 4])).toEqual([2, 6]);
  });
  it("move labels apart, in order, within their room", () => {
    expect(spread([50, 52, 10], 10, 0, 100)).toEqual([50, 60, 10]);
    expect(spread([99, 100], 10, 0, 100)).toEqual([90, 100]);
  });
});

describe("step curves", () => {
  const curve = { x: [0, 3, 8], y: [0, 1, 4] };
  it("keep a value until the next point", () => {
    expect([valueAt(curve, 2.9), valueAt(curve, 3), valueAt(curve, 100)]).toEqual([0, 1, 4]);
    expect(valueAt(curve, -1)).toBeUndefined();
  });
  it("are drawn as steps", () => {
    expect(stepPath(curve, same, same)).toBe("M0.0,0.0H3.0V1.0H8.0V4.0");
  });
  it("enclose a band, forth at its top and back at its bottom", () => {
    expect(bandPath([0, 5], [0, 1], [2, 3], same, same)).toBe("M0.0,2.0H5.0V3.0V1.0H5.0V0.0H0.0Z");
    expect(bandPath([], [], [], same, same)).toBe("");
  });
});

describe("survival", () => {
  it("falls at each event by its share of those that still wait", () => {
    const curve = survival([
      { event: 2, until: 10 },
      { event: 5, until: 10 },
      { event: null, until: 10 },
      { event: null, until: 10 },
    ]);
    expect(curve.x).toEqual([0, 2, 5, 10]);
    expect(curve.y.map((y) => Math.round(y * 100))).toEqual([100, 75, 50, 50]);
  });
  it("leaves out those that ended before without the event", () => {
    const curve = survival([
      { event: 6, until: 10 },
      { event: null, until: 4 },
    ]);
    expect(curve).toEqual({ x: [0, 6, 10], y: [1, 0, 0] });
  });
});

describe("objectives", () => {
  it("keep the best value so far", () => {
    expect(bestSoFar([null, 3, 4, null, 1])).toEqual([null, 3, 3, 3, 1]);
  });
  it("have a front without points that another one beats", () => {
    const points = [
      [3, 1],
      [1, 3],
      [2, 2],
      [2, 4],
      [3, 3],
      [1, 3],
    ] as const;
    expect(paretoFront(points)).toEqual([1, 2, 0]);
  });
});

describe("boxes", () => {
  it("have interpolated quartiles, and whiskers without outliers", () => {
    expect(boxOf([1, 2, 3, 4, 100])).toEqual({ low: 1, q1: 2, median: 3, q3: 4, high: 4 });
    expect(boxOf([1, 2])).toEqual({ low: 1, q1: 1.25, median: 1.5, q3: 1.75, high: 2 });
    expect(boxOf([])).toBeUndefined();
  });
});
