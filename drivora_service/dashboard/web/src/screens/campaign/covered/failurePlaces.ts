import type { Schemas } from "../../../api/client";

type Failure = Schemas["Failure"];

/** A failure where it began. */
export interface FailurePlace {
  readonly failure: Failure;
  readonly town: string;
  readonly x: number;
  readonly y: number;
  /** Whether an ego was at fault and the failure was avoidable. */
  readonly isAvoidable: boolean;
}

/** Returns the failures that have a place. */
export function placesOf(
  failures: readonly Failure[],
  townOf: (evaluation: number) => string,
): readonly FailurePlace[] {
  return failures.flatMap((failure) => {
    const { at_fault, avoidable, location } = failure.verdict;
    const [x, y] = location ?? [];
    if (x === undefined || y === undefined) return [];
    const isAvoidable = at_fault === true && avoidable === "yes";
    return [{ failure, town: townOf(failure.evaluation), x, y, isAvoidable }];
  });
}
