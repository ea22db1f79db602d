import { expect, it } from "vitest";
import type { Schemas } from "../../api/client";
import { changesBetween } from "./changes";

function block(name: string, values: Readonly<Record<string, number>>): Schemas["Block"] {
  const genes = Object.entries(values).map(([gene, value]) => ({
    name: gene,
    kind: "continuous" as const,
    unit: "m/s",
    low: 0,
    high: 10,
    value,
  }));
  return { name, part: "vehicle", genes };
}

it("names the genes that differ, the greatest change first", () => {
  const parent = [block("vehicle_0", { speed: 4, delay: 1 }), block("vehicle_1", { speed: 2 })];
  const child = [block("vehicle_0", { speed: 5, delay: 1 }), block("vehicle_1", { speed: 9 })];
  expect(changesBetween(parent, child)).toEqual([
    { block: "vehicle_1", gene: "speed", unit: "m/s", from: 2, to: 9, share: 0.7 },
    { block: "vehicle_0", gene: "speed", unit: "m/s", from: 4, to: 5, share: 0.1 },
  ]);
});
it("finds nothing where genes are not known", () => {
  expect(changesBetween([], [block("vehicle_0", { speed: 4 })])).toEqual([]);
});
