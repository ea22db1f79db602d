import { expect, it } from "vitest";
import { freest, sidesOf } from "./signPlaces";

const CAR = { left: 100, top: 100, width: 40, height: 20 };
const SIGN = { width: 20, height: 10 };

it("signs stand around a box, not on it", () => {
  expect(sidesOf(CAR, SIGN, 4)).toEqual([
    { left: 110, top: 86, ...SIGN },
    { left: 110, top: 124, ...SIGN },
    { left: 144, top: 105, ...SIGN },
    { left: 76, top: 105, ...SIGN },
  ]);
});

it("a sign takes the first free place", () => {
  const places = sidesOf(CAR, SIGN, 4);
  expect(freest(places, [CAR], 0)).toBe(0);
  const above = { left: 90, top: 70, width: 40, height: 20 };
  expect(freest(places, [CAR, above], 0)).toBe(1);
});

it("a sign stays where it is while nothing is in the way", () => {
  const places = sidesOf(CAR, SIGN, 4);
  expect(freest(places, [CAR], 2)).toBe(2);
  expect(freest(places, [CAR, { left: 140, top: 100, width: 40, height: 20 }], 2)).toBe(0);
});

it("without a free place a sign covers as little as possible", () => {
  const places = sidesOf(CAR, SIGN, 4);
  const all = { left: 0, top: 0, width: 500, height: 500 };
  const all2 = { left: 0, top: 0, width: 500, height: 124 };
  expect(freest(places, [all, all2], 0)).toBe(1);
});
