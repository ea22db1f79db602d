import { expect, it } from "vitest";
import { leastWidth } from "./DataTable";

it("columns that grow count with their least width", () => {
  expect(leastWidth("28px 180px minmax(160px, 1fr) minmax(90px, 2fr)")).toBe(458);
});
