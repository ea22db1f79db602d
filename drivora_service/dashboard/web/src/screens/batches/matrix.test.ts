import { expect, it } from "vitest";
import type { Schemas } from "../../api/client";
import { faultOpen, matrixOf, OUTCOMES, searchOf } from "./matrix";

const counts = (oracle: Record<string, number>) => ({ oracle }) as Schemas["RunCounts"];

it("oracles are by outcomes, those at fault most often first, and none is left out", () => {
  const rows = matrixOf([
    counts({ collision: 1 }),
    counts({ collision: 1 }),
    counts({ collision: 2, speeding: 9 }),
    counts({ red_light: 4 }),
  ]);
  expect(rows.map(({ oracle }) => oracle)).toEqual(["collision", "speeding", "red_light"]);
  expect(rows[0]?.cells.map(({ number }) => number)).toEqual([1, 1, 2, 0]);
});
it("oracles whose violations are not all of a known fault are named", () => {
  const rows = matrixOf([
    counts({ collision: 1 }),
    counts({ collision: 1 }),
    counts({ collision: 2, destination: 1 }),
  ]);
  expect(faultOpen(rows)).toEqual(["destination"]);
});
it("a cell leads to its runs", () => {
  const column = OUTCOMES[0];
  if (!column) throw new Error("no columns");
  expect(searchOf("b", "collision", column)).toEqual({
    batch: "b",
    oracle: "collision",
    outcome: "violated",
    at_fault: "true",
  });
});
