import type { Schemas } from "../../api/client";
import type { MarkLook } from "../../components/Mark";
import type { Share } from "../../components/Shares";
import { NOT_JUDGED } from "../runs/status";

export type Batch = Schemas["Batch"];
export type Priority = Schemas["Priority"];
export type BatchAction = "pause" | "resume" | "cancel";

const RANKS: Readonly<Record<Priority, number>> = { interactive: 0, ci: 1, campaign: 2 };

/** The priorities of batches, the most urgent first. */
export const PRIORITIES = Object.keys(RANKS) as readonly Priority[];

export const isPriority = (value: string): value is Priority =>
  PRIORITIES.some((priority) => priority === value);

/** How many runs of a batch are where. */
export interface Standing {
  readonly waiting: number;
  readonly running: number;
  readonly violated: number;
  readonly passed: number;
  readonly notJudged: number;
  readonly cancelled: number;
  readonly ended: number;
}

export function standingOf(batch: Batch): Standing {
  const of = (status: string) => batch.counts?.[status] ?? 0;
  const notJudged = NOT_JUDGED.reduce((sum, status) => sum + of(status), 0);
  const waiting = of("queued");
  const running = of("running");
  return {
    waiting,
    running,
    violated: batch.violated_runs,
    passed: of("finished") - batch.violated_runs,
    notJudged,
    cancelled: of("cancelled"),
    ended: batch.size - waiting - running,
  };
}

/** Returns the parts of a batch's bar; what waits is the rest of the bar. */
export function sharesOf(batch: Batch): readonly Share[] {
  const at = standingOf(batch);
  return [
    { words: "with violations", number: at.violated, tone: "bad" },
    { words: "passed", number: at.passed, tone: "good" },
    { words: "not judged", number: at.notJudged, tone: "lost" },
    { words: "cancelled", number: at.cancelled, tone: "quiet" },
    { words: "running", number: at.running, tone: "live" },
  ];
}

/** Returns how a batch's state is shown. */
export function lookOfBatch(batch: Batch): MarkLook {
  if (batch.state === "cancelled") return { sign: "–", tone: "quiet", text: "cancelled" };
  if (batch.done) return { sign: "✓", tone: "good", text: "ended" };
  if (batch.state === "paused") return { sign: "‖", tone: "lost", text: "paused" };
  return standingOf(batch).running > 0
    ? { sign: "▸", tone: "live", text: "running" }
    : { sign: "○", tone: "quiet", text: "queued" };
}

/** Returns what can be done with a batch in its state. */
export function actionsOf(batch: Batch): readonly BatchAction[] {
  if (batch.done || batch.state === "cancelled") return [];
  return batch.state === "paused" ? ["resume", "cancel"] : ["pause", "cancel"];
}

/** The order in which batches are compared: the older one is A. */
export function olderFirst(a: Batch, b: Batch): number {
  return a.created_at.localeCompare(b.created_at) || a.id.localeCompare(b.id);
}
