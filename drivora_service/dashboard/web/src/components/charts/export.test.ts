import { expect, it } from "vitest";
import { csvOf } from "./export";

it("tables become CSV with quoted texts and empty fields for what is not known", () => {
  const rows = [
    ["left turn, wet", 3, null],
    ['the "best"', Number.NaN, 0.5],
  ];
  expect(csvOf({ columns: ["scenario", "failing", "share"], rows })).toBe(
    'scenario,failing,share\r\n"left turn, wet",3,\r\n"the ""best""",,0.5\r\n',
  );
});
