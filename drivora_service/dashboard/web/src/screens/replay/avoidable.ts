import type { Schemas } from "../../api/client";

/**
 * Returns the last moment at which a violation could still be avoided, seconds, by what its verdict
 * says; null where it was not avoidable, or that is not measurable.
 */
export function avoidableUntil({
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
