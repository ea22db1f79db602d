import { expect, it } from "vitest";
import { colourNumber } from "./palette";

it("colours are read in both forms that a style sheet has", () => {
  expect(colourNumber(" #1f5fa8")).toBe(0x1f5fa8);
  expect(colourNumber("#fff")).toBe(0xffffff);
});
