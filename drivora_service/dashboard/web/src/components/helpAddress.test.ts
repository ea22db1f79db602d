import { expect, it } from "vitest";
import { helpAddress } from "./helpAddress";

it("a page of the documentation has an address of the service", () => {
  const page = "docs/how-to/when-everything-or-nothing-fails.md";
  expect(helpAddress(page)).toBe("/help/when-everything-or-nothing-fails");
  expect(helpAddress(`${page}#nothing-fails`)).toBe("/help/when-everything-or-nothing-fails");
});
