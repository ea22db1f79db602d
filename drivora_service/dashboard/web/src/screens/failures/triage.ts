import type { Schemas } from "../../api/client";
import type { MarkLook } from "../../components/Mark";
import { count } from "../../components/numbers";
import { groupText } from "./words";

export type Group = Schemas["FailureGroup"];
export type GroupStatus = Schemas["GroupStatus"];
export type Since = Schemas["SinceBaseline"];
export type GroupChange = Schemas["GroupChange"];

/** How it is shown what was decided about a group. */
export const STATUS: Readonly<Record<GroupStatus, MarkLook>> = {
  new: { sign: "●", tone: "live", text: "new" },
  known: { sign: "◇", tone: "quiet", text: "known" },
  fixed: { sign: "✓", tone: "good", text: "fixed" },
  will_not_fix: { sign: "–", tone: "quiet", text: "will not fix" },
};

export const STATUSES = Object.keys(STATUS) as readonly GroupStatus[];

/** How it is shown how a group stands to the baseline. */
export const SINCE: Readonly<Record<Since, MarkLook>> = {
  new: { sign: "+", tone: "bad", text: "not in the baseline" },
  same: { sign: "=", tone: "quiet", text: "in the baseline, too" },
  gone: { sign: "−", tone: "good", text: "in the baseline only" },
};

export const SINCES = Object.keys(SINCE) as readonly Since[];

/** Returns how the status of a group is shown; one that was fixed and was found again is bad. */
export function lookOfGroup({ status, is_back }: Pick<Group, "status" | "is_back">): MarkLook {
  return is_back ? { sign: "↺", tone: "bad", text: "fixed, and found again" } : STATUS[status];
}

/** Returns what a group is called: its label, or what its failures have in common. */
export function titleOf({ label, names }: Pick<Group, "label" | "names">): string {
  return label || names.map(groupText).join("; ");
}

/** Returns how many failures a group has, and how many of them a careful driver avoids. */
export function countWords({
  failures,
  avoidable,
  preventable,
}: Pick<Group, "failures" | "avoidable" | "preventable">): string {
  if (failures === 0) return "none left";
  const parts = [
    `${count(failures)} ${failures === 1 ? "failure" : "failures"}`,
    ...(avoidable > 0 ? [`${count(avoidable)} avoidable`] : []),
    ...(preventable > 0 ? [`${count(preventable)} not at fault, but avoidable`] : []),
  ];
  return parts.join(", ");
}

/** Returns one change of a group in words. */
export function changeWords({ what, before, after }: GroupChange): string {
  if (what === "merged") return `merged ${after} into it`;
  if (what === "split") return after ? `split it off ${before}` : `split off ${before}`;
  const said = (text: string) =>
    what === "status" ? (STATUS[text as GroupStatus]?.text ?? text) : text;
  if (what === "note") return after ? `noted: ${after}` : "removed the note";
  return `${what}: ${said(before) || "none"} → ${said(after) || "none"}`;
}

/** Returns a baseline in words: a time as it is read, an id as it is. */
export function isTime(baseline: string): boolean {
  return /^\d{4}-\d\d-\d\dT/.test(baseline);
}
