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
