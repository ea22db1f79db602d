import type { Schemas } from "../../api/client";
import { minimizationOf } from "../minimizations/minimization";
import { alike, gravestFirst } from "./verdictWords";

/**
 * Returns the violations that a minimisation of a run may follow, the gravest of each oracle, the
 * gravest first; none if no ego is at fault, or a minimisation has made the run.
 */
export function minimizable(
  run: Pick<Schemas["Run"], "id" | "status" | "verdicts">,
): readonly Schemas["Verdict"][] {
  if (run.status !== "finished" || minimizationOf(run.id)) return [];
  const failing = gravestFirst(run.verdicts).filter(({ severity }) => severity !== "observation");
  if (!failing.some(({ at_fault }) => at_fault === true)) return [];
  return alike(failing).map(({ first }) => first);
}
