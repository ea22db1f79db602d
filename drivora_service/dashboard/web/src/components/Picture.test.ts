import { expect, it } from "vitest";
import { violationQuery } from "./Picture";

it("a picture is asked for the violation that a card is about", () => {
  expect(violationQuery({ oracle: "collision", ego: "ego 0", step: 84 })).toBe(
    "?oracle=collision&ego=ego+0&step=84",
  );
  expect(violationQuery({ oracle: "collision", ego: "e", step: null })).toBe(
    "?oracle=collision&ego=e",
  );
});
