import { expect, it } from "vitest";
import {
  holding,
  isPart,
  seatsOf,
  shifted,
  ticks,
  valueTicks,
  withinRun,
  zoomRange,
} from "./timeScale";

it("a range comes nearer around a time, and stays within the run", () => {
  expect(zoomRange({ from: 0, to: 20 }, 5, 2, 20)).toEqual({ from: 2.5, to: 12.5 });
  expect(zoomRange({ from: 2.5, to: 12.5 }, 5, 0.01, 20)).toEqual({ from: 0, to: 20 });
  expect(zoomRange({ from: 0, to: 20 }, 20, 1000, 20)).toEqual({ from: 19.5, to: 20 });
});
it("a range moves no farther than the run's ends", () => {
  expect(shifted({ from: 5, to: 10 }, -9, 20)).toEqual({ from: 0, to: 5 });
  expect(shifted({ from: 5, to: 10 }, 99, 20)).toEqual({ from: 15, to: 20 });
});
it("a range moves on with a time that leaves it, and stays where it is otherwise", () => {
  const range = { from: 5, to: 10 };
  expect(holding(range, 10, 40)).toBe(range);
  expect(holding(range, 10.1, 40)).toEqual({ from: 10.1 - 0.75, to: 15.1 - 0.75 });
  const back = holding(range, 4.9, 40);
  expect(back.from).toBeCloseTo(0.65);
  expect(back.to - back.from).toBeCloseTo(5);
  expect(holding(range, 39, 40)).toEqual({ from: 35, to: 40 });
  expect(holding(range, 0, 40)).toEqual({ from: 0, to: 5 });
});
it("a range of an address is within the run", () => {
  expect(withinRun(undefined, 20)).toEqual({ from: 0, to: 20 });
  expect(withinRun({ from: 5, to: 10 }, 20)).toEqual({ from: 5, to: 10 });
  expect(withinRun({ from: 15, to: 99 }, 20)).toEqual({ from: 15, to: 20 });
  expect(withinRun({ from: 19.9, to: 20 }, 20)).toEqual({ from: 19.5, to: 20 });
  expect(withinRun({ from: 30, to: 40 }, 20)).toEqual({ from: 0, to: 20 });
  expect(isPart(withinRun({ from: 0, to: 20.001 }, 20), 20)).toBe(false);
  expect(isPart({ from: 0, to: 19 }, 20)).toBe(true);
});
it("ticks are round", () => {
  expect(ticks({ from: 0, to: 60 }, 8)).toEqual([0, 10, 20, 30, 40, 50, 60]);
  expect(ticks({ from: 1.03, to: 1.52 }, 6)).toEqual([1.1, 1.2, 1.3, 1.4, 1.5]);
});
it("marks of a row do not cover each other", () => {
  const marks = [
    { row: "a", time: 2 },
    { row: "a", time: 8.5 },
    { row: "a", time: 8.5 },
    { row: "b", time: 8.5 },
  ];
  expect(seatsOf(marks, 0.5)).toEqual([2, 8, 8.5, 8.5]);
});
it("the gravest of the marks of one moment stays there", () => {
  const marks = [
    { row: "a", time: 8.25, weight: 2 },
    { row: "a", time: 8.25, weight: 1 },
  ];
  expect(seatsOf(marks, 0.5)).toEqual([8.25, 7.75]);
});
it("an axis has at least two labelled values", () => {
  // The acceleration of a run on a wet motorway, with the grip around it.
  expect(valueTicks(-4.9, 4.9, 4)).toEqual([-4, -2, 0, 2, 4]);
  expect(valueTicks(-9.9, 9.9, 4)).toEqual([-5, 0, 5]);
  expect(valueTicks(0, 10, 4)).toEqual([0, 5, 10]);
  expect(valueTicks(0, 1, 4)).toEqual([0, 0.5, 1]);
  for (let low = -20; low <= 5; low += 0.37)
    for (let high = low + 0.11; high < low + 60; high *= high > 1 ? 1.09 : 1, high += 0.31) {
      const found = valueTicks(low, high, 4);
      expect(found.length).toBeGreaterThanOrEqual(2);
      expect(found.length).toBeLessThanOrEqual(7);
      expect(found.every((value) => value >= low - 1e-6 && value <= high + 1e-6)).toBe(true);
    }
});
