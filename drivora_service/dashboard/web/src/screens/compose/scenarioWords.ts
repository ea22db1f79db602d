import { type Json, type JsonObject, valueAt } from "../../components/fields/pointers";

/** Returns the road network of a scenario. */
export function townOf(scenario: JsonObject): string {
  const town = valueAt(scenario, "/map_region/town");
  return typeof town === "string" ? town : "";
}

/** Returns the ADSs of a scenario's egos, as lists show them. */
export function agentsOf(scenario: JsonObject): string {
  const egos = valueAt(scenario, "/ego_vehicles");
  const names = (Array.isArray(egos) ? egos : []).map((ego: Json) => valueAt(ego, "/agent/name"));
  return [...new Set(names.filter((name): name is string => typeof name === "string"))]
    .sort()
    .join(", ");
}

const PARTS = [
  ["ego_vehicles", "ego", "egos"],
  ["npc_vehicles", "NPC vehicle", "NPC vehicles"],
  ["npc_walkers", "walker", "walkers"],
  ["npc_obstacles", "obstacle", "obstacles"],
  ["friction_patches", "slippery patch", "slippery patches"],
] as const;

/** Returns what is in a scenario: its network, and how many actors of each sort. */
export function partsOf(scenario: JsonObject): readonly string[] {
  const counts = PARTS.flatMap(([key, one, many]) => {
    const items = scenario[key];
    const count = Array.isArray(items) ? items.length : 0;
    return count === 0 ? [] : [`${count} ${count === 1 ? one : many}`];
  });
  return [townOf(scenario), ...counts].filter(Boolean);
}
