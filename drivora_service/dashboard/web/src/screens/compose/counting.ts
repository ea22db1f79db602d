import type { Schemas } from "../../api/client";
import { COUNTED_WORDS, countedOf } from "../../components/definition";
import { isSame } from "../../components/fields/typed";
import type { Catalogues } from "./catalogues";
import type { Draft } from "./draft";

type Known = Pick<Catalogues, "oracles">;

/** Returns the oracles that count where a document names none: all but observations. */
export function standardOracles({ oracles }: Known): readonly string[] {
  return oracles.filter(({ severity }) => severity !== "observation").map(({ name }) => name);
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

/**
 * Returns a draft that counts what was defined for the runs of its scenarios: a search from a
 * failure finds the same failure again. What the draft says itself stays.
 */
export function countingAsDefined(draft: Draft): Draft {
  const { counts, oracles } = draft.settings;
  const defined = draft.scenarios.flatMap(({ definition }) => definition ?? [])[0];
  if (!defined || counts !== undefined || oracles !== undefined) return draft;
  const settings = {
    ...draft.settings,
    ...(defined.counts && defined.counts !== "accountable" ? { counts: defined.counts } : {}),
    ...(defined.oracles ? { oracles: [...defined.oracles] } : {}),
  };
  return { ...draft, settings };
}

/** Returns what counts as a failure in a draft, in words. */
export function countedInWords({ settings }: Draft): string {
  const counts = countedOf(String(settings.counts ?? "")) ?? "accountable";
  const oracles =
    settings.oracles === undefined
      ? "all oracles but observations"
      : namesIn(settings.oracles)
          .map((name) => name.replaceAll("_", " "))
          .join(", ");
  return `violations ${COUNTED_WORDS[counts]}, of ${oracles}`;
}

/** What was defined as a failure for a run. */
export type Defined = Pick<Schemas["StatedDefinition"], "counts" | "oracles">;

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
