import { expect, it } from "vitest";
import { tableAddress } from "./resultTables";

it("a table is of the runs of all filters, each value by itself", () => {
  expect(tableAddress("metrics", {})).toBe("/api/v1/tables/metrics");
  expect(tableAddress("runs", { status: ["finished", "timed_out"], agent: "a b&c" })).toBe(
    "/api/v1/tables/runs?status=finished&status=timed_out&agent=a+b%26c",
  );
});
