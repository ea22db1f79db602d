import { expect, it } from "vitest";
import { holding, isPart, seatsOf, shifted, ticks, withinRun, zoomRange } from "./timeScale";

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
