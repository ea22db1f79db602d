import type { Schemas } from "../../api/client";
import { minimizationOf } from "../minimizations/minimization";
import { alike, failuresOf, gravestFirst } from "./verdictWords";

/**
 * Returns the violations that a minimisation of a run may follow, the gravest of each oracle: its
 * failures first, then the others; none without a failure, or if a minimisation has made the run.
 */
export function minimizable(
  run: Pick<Schemas["Run"], "id" | "status" | "verdicts" | "failing_verdicts">,
): readonly Schemas["Verdict"][] {
  if (run.status !== "finished" || minimizationOf(run.id)) return [];
  const failures = failuresOf(run);
  if (failures.length === 0) return [];
  const others = gravestFirst(run.verdicts, failures).filter(
    (one) => failures.includes(one) || one.severity !== "observation",
  );
  return alike(others).map(({ first }) => first);
}
