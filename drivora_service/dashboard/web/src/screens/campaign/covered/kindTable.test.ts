import { expect, it } from "vitest";
import { kindTable } from "./kindTable";

it("kinds of scenarios are a table of what occurs, in a fixed order", () => {
  const left = {
    turn: "left",
    others: "walkers",
    simulations: 9,
    failing: 2,
    avoidable: 1,
  } as const;
  const right = { ...left, turn: "right", others: "vehicles", simulations: 4 } as const;
  const table = kindTable([right, left]);
  expect(table.turns).toEqual(["left", "right"]);
  expect(table.others).toEqual(["vehicles", "walkers"]);
  expect(table.at("left", "walkers")).toBe(left);
  expect(table.at("left", "vehicles")).toBeUndefined();
  expect(kindTable([]).turns).toEqual([]);
});
