import type { Schemas } from "../../api/client";

type Campaign = Schemas["CampaignSummary"];

/** The repetitions of a method on a scenario with an ADS, taken together. */
export interface Cell {
  readonly scenario: string;
  readonly agent: string;
  readonly method: string;
  readonly campaigns: readonly Campaign[];
  readonly simulations: number;
  readonly failing: number;
  /** Simulations with a failure that counts; null where one campaign did not record it. */
  readonly avoidable: number | null;
}

/** Returns the key of a cell. */
export function keyOf(scenario: string, agent: string, method: string): string {
  return JSON.stringify([scenario, agent, method]);
}

/** Returns the campaigns of a study by their cells. */
export function cellsOf(campaigns: readonly Campaign[]): ReadonlyMap<string, Cell> {
  const found = new Map<string, Cell>();
  for (const campaign of campaigns) {
    if (!campaign.cell) continue;
    const { scenario, agent, method } = campaign.cell;
    const key = keyOf(scenario, agent, method);
    const before = found.get(key);
    const { avoidable } = campaign.counts;
    found.set(key, {
      scenario,
      agent,
      method,
      campaigns: [...(before?.campaigns ?? []), campaign],
      simulations: (before?.simulations ?? 0) + campaign.simulations,
      failing: (before?.failing ?? 0) + campaign.counts.violating,
      avoidable:
        avoidable === null || before?.avoidable === null
          ? null
          : (before?.avoidable ?? 0) + avoidable,
    });
  }
  return found;
}

/** Returns the names of scenarios, ADSs and methods in the order of their first campaigns. */
export function axesOf(cells: ReadonlyMap<string, Cell>) {
  const all = [...cells.values()];
  return {
    scenarios: [...new Set(all.map(({ scenario }) => scenario))],
    agents: [...new Set(all.map(({ agent }) => agent))],
    methods: [...new Set(all.map(({ method }) => method))],
  };
}

const REPETITIONS_NEEDED = 2;
/** The method that others are compared with, if a study has it. */
const BASELINE = "random";

/** Returns whether the service has something to compare with the baselines, "" the usual ones. */
export function canCompare(
  cells: ReadonlyMap<string, Cell>,
  baselines: { readonly method: string; readonly agent: string },
): boolean {
  const { methods, agents } = axesOf(cells);
  const usual = methods.includes(BASELINE) ? BASELINE : methods[0];
  const method = baselines.method || usual;
  const agent = baselines.agent || agents[0];
  const ready = [...cells.values()].filter(
    ({ campaigns }) =>
      campaigns.filter(({ state }) => state === "finished").length >= REPETITIONS_NEEDED,
  );
  return ready.some((one) =>
    ready.some(
      (other) =>
        one.scenario === other.scenario &&
        ((one.method === method && other.method !== method && one.agent === other.agent) ||
          (one.agent === agent && other.agent !== agent && one.method === other.method)),
    ),
  );
}
