import { expect, it } from "vitest";
import { absentWords, hasValues, plotGroups } from "./plotGroups";

const GROUPS = plotGroups(0, "sumo-idm");
const NONE = new Float64Array(3).fill(Number.NaN);

it("a plot without a value is left out, one with a single value is not", () => {
  const values = new Map([
    ["speed", Float64Array.of(1, 2, 3)],
    ["gap", Float64Array.of(Number.NaN, 2, Number.NaN)],
  ]);
  const drawn = GROUPS.filter((group) => hasValues(group, (name) => values.get(name) ?? NONE));
  expect(drawn.map(({ title }) => title)).toEqual(["Speed (m/s)", "TTC (s), gap (m)"]);
});

it("what is left out is told with its reason", () => {
  expect(absentWords([])).toBe("");
  expect(absentWords(GROUPS.slice(3))).toBe(
    "Not drawn: Controls, as sumo-idm drives without throttle, brake and steering.",
  );
  expect(absentWords(GROUPS.slice(2))).toBe(
    "Not drawn: TTC, gap, as there was no other actor; " +
      "Controls, as sumo-idm drives without throttle, brake and steering.",
  );
});
