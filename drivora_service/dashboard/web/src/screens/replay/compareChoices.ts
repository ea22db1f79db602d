import type { Schemas } from "../../api/client";
import { isId } from "../../shell/found";

type Summary = Pick<
  Schemas["RunSummary"],
  "id" | "label" | "configuration" | "scenario_sha256" | "trace_sha256"
>;

/** Runs of a group that are offered. */
export const MOST_OFFERED = 30;

/**
 * Returns recorded runs to compare one with: of its scenario, and others of its network, those
 * first of which it is a replay, or which are named alike. `words` leaves those that have them in
 * their id, their label or their ADS.
 */
export function choicesOf<Run extends Summary>(
  run: Summary,
  ofScenario: readonly Run[],
  ofNetwork: readonly Run[],
  words = "",
): { readonly scenario: readonly Run[]; readonly network: readonly Run[] } {
  const wanted = words.toLowerCase().split(/\s+/).filter(Boolean);
  const usable = (one: Run) => {
    const text = `${one.id} ${one.label} ${one.configuration}`.toLowerCase();
    return (
      one.id !== run.id && one.trace_sha256 !== "" && wanted.every((word) => text.includes(word))
    );
  };
  const origin = originOf(run);
  const near = ({ id, label }: Run) =>
    id === origin ? 2 : Number(run.label !== "" && label === run.label);
  const scenario = ofScenario.filter(usable).sort((a, b) => near(b) - near(a));
  const same = new Set(scenario.map(({ id }) => id));
  return {
    scenario,
    network: ofNetwork
      .filter((one) => usable(one) && !same.has(one.id))
      .sort((a, b) => near(b) - near(a)),
  };
}

/** Returns the id of the run that a run repeats, by its label; empty for none. */
export function originOf({ label }: Pick<Summary, "label">): string {
  return /^replay of (\S+)$/.exec(label)?.[1] ?? "";
}

/** Returns the label of a run that repeats another. */
export function repeatLabel(id: string): string {
  return `replay of ${id}`;
}

/** Returns the id of a run in what was pasted, an id or the address of its page; empty for none. */
export function pastedId(text: string): string {
  const id = text
    .trim()
    .replace(/[?#].*$/, "")
    .replace(/^.*\/runs\//, "")
    .toLowerCase();
  return isId(id) ? id : "";
}
