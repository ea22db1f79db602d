import { expect, it } from "vitest";
import { seatsOf, shifted, ticks, zoomRange } from "./timeScale";

it("a range comes nearer around a time, and stays within the run", () => {
  expect(zoomRange({ from: 0, to: 20 }, 5, 2, 20)).toEqual({ from: 2.5, to: 12.5 });
  expect(zoomRange({ from: 2.5, to: 12.5 }, 5, 0.01, 20)).toEqual({ from: 0, to: 20 });
  expect(zoomRange({ from: 0, to: 20 }, 20, 1000, 20)).toEqual({ from: 19.5, to: 20 });
});
it("a range moves no farther than the run's ends", () => {
  expect(shifted({ from: 5, to: 10 }, -9, 20)).toEqual({ from: 0, to: 5 });
  expect(shifted({ from: 5, to: 10 }, 99, 20)).toEqual({ from: 15, to: 20 });
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
