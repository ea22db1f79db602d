import type { Schemas } from "../../api/client";
import { propertiesOf } from "../../components/fields/jsonSchema";
import { isSame } from "../../components/fields/typed";
import type { Catalogues } from "./catalogues";
import type { Draft } from "./draft";

type Known = Pick<Catalogues, "definitions" | "oracles">;

/** Returns the oracles that count where a document names none. */
export function standardOracles({ definitions }: Pick<Known, "definitions">): readonly string[] {
  return namesIn(propertiesOf(definitions.CampaignDocument, definitions).oracles?.default);
}

/** Returns the oracles whose violations count in a draft. */
export function countedOracles(known: Known, { settings }: Draft): readonly string[] {
  return settings.oracles === undefined ? standardOracles(known) : namesIn(settings.oracles);
}

/** Returns a draft in which certain oracles count, in the order of the catalogue. */
export function withCounted(known: Known, draft: Draft, names: readonly string[]): Draft {
  const { oracles: _, ...others } = draft.settings;
  const isStandard = isSame(names.toSorted(), standardOracles(known).toSorted());
  const settings = isStandard ? others : { ...others, oracles: inOrder(names, known.oracles) };
  return { ...draft, settings };
}

/** Returns the oracles that the runs of the draft's scenarios violated, and that do not count by default. */
export function violatedBeside(known: Known, { scenarios }: Draft): readonly string[] {
  const standard = standardOracles(known);
  const found = scenarios.flatMap(({ violated = [] }) => violated);
  return [...new Set(found)].filter((name) => !standard.includes(name));
}

/**
 * Returns a draft in which the oracles that the runs of new scenarios violated count as well: a
 * search from a failure finds the same failure again.
 */
export function countingViolated(known: Known, draft: Draft, before?: Draft): Draft {
  const old = before ? violatedBeside(known, before) : [];
  const counted = countedOracles(known, draft);
  const added = violatedBeside(known, draft).filter(
    (name) => !old.includes(name) && !counted.includes(name),
  );
  return added.length === 0 ? draft : withCounted(known, draft, [...counted, ...added]);
}

/** Returns the oracles that an ego violated at its fault, each once; observations are none. */
export function violatedAtFault(
  verdicts: readonly Pick<Schemas["Verdict"], "oracle" | "outcome" | "severity" | "at_fault">[],
): readonly string[] {
  const found = verdicts.filter(
    ({ outcome, severity, at_fault }) =>
      outcome === "violated" && severity !== "observation" && at_fault === true,
  );
  return [...new Set(found.map(({ oracle }) => oracle))];
}

function namesIn(value: unknown): readonly string[] {
  return Array.isArray(value) ? value.map(String) : [];
}

/** Returns names in the order of the catalogue; others stand at the end. */
function inOrder(
  names: readonly string[],
  oracles: readonly Pick<Schemas["Oracle"], "name">[],
): readonly string[] {
  const known = oracles.map(({ name }) => name);
  return [
    ...known.filter((name) => names.includes(name)),
    ...names.filter((name) => !known.includes(name)),
  ];
}
