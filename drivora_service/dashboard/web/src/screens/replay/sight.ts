import type { Schemas } from "../../api/client";
import type { Ways } from "./opening";

/**
 * Returns the row of the ego that a map keeps in sight at a step: the wanted one, another that is
 * in the run while that one is not, and the wanted one where none is.
 */
export function egoInSight({ x, egos, actors }: Ways, wanted: number, step: number): number {
  const isThere = (row: number) => !Number.isNaN(x[step * actors.length + row] ?? Number.NaN);
  if (isThere(wanted)) return wanted;
  for (let row = 0; row < egos; row++) if (isThere(row)) return row;
  return wanted;
}

/** Returns the row of the ego of which a violation begins at a step; undefined if none does. */
export function egoOfMark(
  violations: readonly Pick<Schemas["ViolationMark"], "ego" | "first">[],
  actors: readonly { readonly id: string }[],
  step: number,
): number | undefined {
  const begun = violations.find(({ first }) => first === step);
  const row = actors.findIndex(({ id }) => id === begun?.ego);
  return row < 0 ? undefined : row;
}
