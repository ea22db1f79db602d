import { describe, expect, it } from "vitest";
import { beside, dashes, footOn, isInside, lengthOf, partOf, placeAt } from "./lines";

const CORNER = [0, 0, 10, 0, 10, 10];

describe("lines", () => {
  it("have points at distances", () => {
    expect(lengthOf(CORNER)).toBe(20);
    expect(placeAt(CORNER, 15)).toEqual({ x: 10, y: 5, heading: Math.PI / 2 });
    expect(placeAt(CORNER, 99)).toMatchObject({ x: 10, y: 10 });
  });
  it("have parts by length, with the corners between", () => {
    expect(partOf(CORNER, 5, 15)).toEqual([5, 0, 10, 0, 10, 5]);
    expect(partOf(CORNER, 10, 20)).toEqual([10, 0, 10, 10]);
    expect(partOf(CORNER, 2, 4)).toEqual([2, 0, 4, 0]);
  });
  it("have lines beside them, left positive", () => {
    const left = beside(CORNER, 1);
    [0, 1, 9, 1, 9, 10].forEach((value, place) => {
      expect(left[place]).toBeCloseTo(value, 9);
    });
  });
  it("tell where a point is along and beside them", () => {
    expect(footOn(CORNER, 4, 2)).toEqual({ along: 4, lateral: 2, distance: 2 });
    expect(footOn(CORNER, 11, 6)).toMatchObject({ along: 16, lateral: -1 });
  });
  it("are broken into dashes that end with the line", () => {
    const found = dashes([0, 0, 10, 0], 3, 4);
    expect(found).toEqual([
      [2, 0, 5, 0],
      [9, 0, 10, 0],
    ]);
  });
  it("hold points as outlines", () => {
    const square = [0, 0, 4, 0, 4, 4, 0, 4];
    expect(isInside(square, 1, 1)).toBe(true);
    expect(isInside(square, 5, 1)).toBe(false);
  });
});
