import { expect, it } from "vitest";
import { agentsOf, partsOf } from "./scenarioWords";

const scenario = {
  ego_vehicles: [{ id: "a", agent: { name: "idm" } }, { id: "b" }],
  npc_walkers: [{ id: "w" }],
  map_region: { town: "tee-town" },
};

it("what is in a scenario is said in words", () => {
  expect(partsOf(scenario)).toEqual(["tee-town", "2 egos", "1 walker"]);
  expect(partsOf({})).toEqual([]);
  expect(agentsOf(scenario)).toBe("idm");
});
