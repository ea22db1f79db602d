import { expect, it } from "vitest";
import { adviceFor } from "./advice";

it("a part of the page that is gone is told apart from an error of the page", () => {
  const chrome = new TypeError("Failed to fetch dynamically imported module: /assets/Runs-1.js");
  const firefox = new TypeError("error loading dynamically imported module: /assets/Runs-1.js");
  const safari = new TypeError("Importing a module script failed.");
  for (const error of [chrome, firefox, safari])
    expect(adviceFor(error).title).toContain("could not be loaded");
  expect(adviceFor(new TypeError("x is undefined")).title).toContain("cannot be shown");
});
