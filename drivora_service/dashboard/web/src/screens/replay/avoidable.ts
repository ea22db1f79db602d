import type { Schemas } from "../../api/client";

/** Returns the last moment at which a violation could still be avoided, seconds; null for none. */
export function avoidableUntil(
  violations: readonly Schemas["ViolationMark"][],
  verdict: Schemas["Verdict"],
  stepLength: number,
): number | null {
  const mark = violations.find(
    ({ oracle, ego, first, counterpart }) =>
      oracle === verdict.oracle &&
      ego === verdict.ego &&
      first === verdict.step &&
      counterpart === verdict.counterpart,
  );
  const until = mark?.avoidable_until;
  return typeof until === "number" ? until * stepLength : null;
}

/**
 * Returns the same by what the verdict itself says, for a run without a recording as well; null
 * where it was not avoidable, or that is not measurable.
 */
export function avoidableUntilOf({
  avoidable,
  time,
  evidence,
}: Pick<Schemas["Verdict"], "avoidable" | "time" | "evidence">): number | null {
  const assessed: unknown = evidence?.avoidability;
  if (avoidable !== "yes" || typeof time !== "number") return null;
  if (typeof assessed !== "object" || assessed === null || !("latest_before" in assessed))
    return null;
  const before = assessed.latest_before;
  return typeof before === "number" ? time - before : null;
}
