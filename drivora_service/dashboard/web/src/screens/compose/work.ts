import { type Json, valueAt } from "../../components/fields/pointers";
import type { Draft, Kind } from "./draft";
import type { Work } from "./estimate";
import { agentsOf, townOf } from "./scenarioWords";

/** Returns the simulations of a draft by ADS and network; none before they are numbers. */
export function workOf(kind: Kind, { scenarios, settings }: Draft): readonly Work[] {
  const simulations = valueAt(settings, "/budget/simulations");
  if (typeof simulations !== "number") return [];
  if (kind === "campaign") {
    const agent = valueAt(settings, "/agent/name");
    return scenarios.map(({ document }) => ({
      agent: typeof agent === "string" ? agent : agentsOf(document),
      town: townOf(document),
      simulations: simulations / scenarios.length,
    }));
  }
  const repetitions = settings.repetitions ?? 1;
  if (typeof repetitions !== "number") return [];
  const methods = itemsOf(settings.methods).length;
  const agents = itemsOf(settings.agents).map((agent) => String(valueAt(agent, "/name")));
  return scenarios.flatMap(({ document }) =>
    (agents.length > 0 ? agents : [agentsOf(document)]).map((agent) => ({
      agent,
      town: townOf(document),
      simulations: simulations * methods * repetitions,
    })),
  );
}

function itemsOf(value: Json | undefined): readonly Json[] {
  return Array.isArray(value) ? value : [];
}
