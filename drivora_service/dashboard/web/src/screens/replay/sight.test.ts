import { expect, it } from "vitest";
import type { Ways } from "./opening";
import { egoInSight, egoOfMark } from "./sight";

const ACTORS = [{ id: "a" }, { id: "b" }, { id: "van" }];

it("an ego that has left the run is followed by one that is still in it", () => {
  const gone = Number.NaN;
  const ways = {
    x: Float32Array.of(1, gone, 1, gone, 2, 2, gone, gone, 3),
    egos: 2,
    actors: ACTORS,
  } as unknown as Ways;
  expect([0, 1, 2].map((step) => egoInSight(ways, 0, step))).toEqual([0, 1, 0]);
  expect([0, 1, 2].map((step) => egoInSight(ways, 1, step))).toEqual([0, 1, 1]);
});

it("a violation turns the map to its ego", () => {
  const violations = [
    { ego: "b", first: 40 },
    { ego: "a", first: null },
  ];
  expect(egoOfMark(violations, ACTORS, 40)).toBe(1);
  expect(egoOfMark(violations, ACTORS, 41)).toBeUndefined();
});
