import { expect, it } from "vitest";
import { ScreenNotLoaded } from "../screen";
import { adviceFor } from "./advice";

it("a part of the page that is gone is told apart from an error of the page", () => {
  const gone = new ScreenNotLoaded(new TypeError("Importing a module script failed."));
  expect(adviceFor(gone).title).toContain("could not be loaded");
  expect(adviceFor(new TypeError("x is undefined")).title).toContain("cannot be shown");
});
