import type { Schemas } from "../../../api/client";

const EVERY = 25;

/**
 * Returns the number of simulations for which values are asked for.
 *
 * Coverage and figures take their time: of a running campaign they are asked for after the first
 * simulation and after each 25, not with each event.
 */
export function askedFor({
  state,
  simulations,
}: Pick<Schemas["Campaign"], "state" | "simulations">): number {
  if (state !== "running") return simulations;
  return simulations < EVERY ? Math.min(simulations, 1) : simulations - (simulations % EVERY);
}
