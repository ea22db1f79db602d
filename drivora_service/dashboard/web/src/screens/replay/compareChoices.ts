import type { Schemas } from "../../api/client";

type Summary = Pick<Schemas["RunSummary"], "id" | "label" | "scenario_sha256" | "trace_sha256">;

/** Runs of a group that are offered. */
export const MOST_OFFERED = 30;

/** Returns recorded runs to compare one with: of its scenario, and others of its network. */
export function choicesOf<Run extends Summary>(
  run: Summary,
  ofScenario: readonly Run[],
  ofNetwork: readonly Run[],
): { readonly scenario: readonly Run[]; readonly network: readonly Run[] } {
  const usable = (one: Run) => one.id !== run.id && one.trace_sha256 !== "";
  const scenario = ofScenario.filter(usable);
  const same = new Set(scenario.map(({ id }) => id));
  const likeNamed = ({ label }: Run) => Number(run.label !== "" && label === run.label);
  return {
    scenario: scenario.slice(0, MOST_OFFERED),
    network: ofNetwork
      .filter((one) => usable(one) && !same.has(one.id))
      .sort((a, b) => likeNamed(b) - likeNamed(a))
      .slice(0, MOST_OFFERED),
  };
}
