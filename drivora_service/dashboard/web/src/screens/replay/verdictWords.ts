import type { Schemas } from "../../api/client";
import type { Tone } from "../../components/Mark";
import { fixed } from "../../components/numbers";

type Verdict = Schemas["Verdict"];
type Violation = Pick<Verdict, "at_fault" | "avoidable"> & {
  readonly undetermined?: boolean;
};

/** Returns the name of an oracle as words. */
export function oracleName(oracle: string): string {
  const words = oracle.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/**
 * Returns whether the ego is at fault and whether a careful driver would have avoided it, in words.
 * `until` is the last moment, in seconds, at which it could still be avoided.
 */
export function blameWords(violation: Violation, until?: number | null): string {
  const parts: string[] = [];
  if (violation.at_fault === true) parts.push("at fault");
  else if (violation.at_fault === false) parts.push("not at fault");
  else if (violation.undetermined) parts.push("fault undetermined");
  if (violation.avoidable === "yes")
    parts.push(typeof until === "number" ? `avoidable until ${fixed(until, 2)} s` : "avoidable");
  else if (violation.avoidable === "no") parts.push("not avoidable");
  else if (violation.avoidable === "not_measurable") parts.push("avoidable or not: not measurable");
  return parts.join(", ");
}

/** Returns the tone of a violation: that of a failure only where the ego is at fault. */
export function toneOf({
  severity,
  at_fault,
}: {
  readonly severity?: Schemas["Severity"];
  readonly at_fault?: boolean | null;
}): Extract<Tone, "bad" | "lost" | "quiet"> {
  if (severity === "observation") return "quiet";
  return at_fault === true ? "bad" : "lost";
}

const RANK: Readonly<Record<string, number>> = { critical: 0, major: 1, minor: 2, observation: 3 };

const AVOIDABILITY: Readonly<Record<string, number>> = { yes: 0, not_measurable: 1, no: 2 };

/** Returns the violations of a run that are failures by its definition. */
export function failuresOf({
  verdicts,
  failing_verdicts,
}: Pick<Schemas["Run"], "verdicts" | "failing_verdicts">): readonly Verdict[] {
  return failing_verdicts.flatMap((place) => verdicts[place] ?? []);
}

/**
 * Sorts violations, the gravest first: failures before others, what only follows from another one
 * behind it, at fault before others, a collision before what did no harm, one that was avoidable
 * before others, the earlier of two alike.
 */
export function gravestFirst(
  verdicts: readonly Verdict[],
  failures: readonly Verdict[] = [],
): readonly Verdict[] {
  const harm = ({ oracle }: Verdict) => Number(oracle === "collision");
  const rank = ({ severity }: Verdict) => RANK[severity ?? "major"] ?? 1;
  const excuse = ({ avoidable }: Verdict) => AVOIDABILITY[avoidable ?? "yes"] ?? 0;
  return verdicts
    .filter(({ outcome }) => outcome === "violated")
    .sort(
      (a, b) =>
        Number(failures.includes(b)) - Number(failures.includes(a)) ||
        Number(rank(a) === 3) - Number(rank(b) === 3) ||
        Number(a.follows !== "") - Number(b.follows !== "") ||
        Number(b.at_fault === true) - Number(a.at_fault === true) ||
        rank(a) - rank(b) ||
        harm(b) - harm(a) ||
        Number(a.at_fault === false) - Number(b.at_fault === false) ||
        excuse(a) - excuse(b) ||
        (a.time ?? Number.POSITIVE_INFINITY) - (b.time ?? Number.POSITIVE_INFINITY),
    );
}

/** Returns the verdicts that say that an artefact of the simulator ended the part of an ego. */
export function artefactsOf(verdicts: readonly Verdict[]): readonly Verdict[] {
  return verdicts.filter(
    ({ outcome, evidence }) => outcome === "not_measurable" && evidence?.artefact !== undefined,
  );
}

/** Returns what follows from other violations, in words: "2 that follow: blocked, destination". */
export function followingWords(verdicts: readonly Verdict[]): string {
  const names = verdicts.map(({ oracle }) => oracle.replaceAll("_", " "));
  return `${verdicts.length} that ${verdicts.length === 1 ? "follows" : "follow"}: ${[...new Set(names)].join(", ")}`;
}

/** Returns how many observations there are, which by themselves make no run fail. */
export function observedWords(count: number): string {
  return count === 1 ? "1 observation" : `${count} observations`;
}

/** Violations of one oracle by one ego or several. */
export interface Alike {
  readonly first: Verdict;
  readonly count: number;
}

/** Gathers violations of one oracle at their first one; the order stays. */
export function alike(violations: readonly Verdict[]): readonly Alike[] {
  const found = new Map<string, Alike>();
  for (const verdict of violations) {
    const before = found.get(verdict.oracle);
    found.set(verdict.oracle, {
      first: before?.first ?? verdict,
      count: (before?.count ?? 0) + 1,
    });
  }
  return [...found.values()];
}

/** Returns what the last moment means at which a careful driver could still act, in words. */
export function untilWords(
  violation: Pick<Schemas["ViolationMark"], "oracle" | "avoidable">,
  until: number,
): string {
  const name = oracleName(violation.oracle);
  if (violation.avoidable === "yes") return `${name}: avoidable until ${fixed(until, 2)} s`;
  const needed = `a careful driver would have had to act by ${fixed(until, 2)} s to avoid it`;
  return violation.avoidable === "no"
    ? `${name}: ${needed}, before there was a reason to`
    : `${name}: ${needed}`;
}
