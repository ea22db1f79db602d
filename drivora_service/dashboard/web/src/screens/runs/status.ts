import type { Schemas } from "../../api/client";
import type { MarkLook } from "../../components/Mark";

type Status = Schemas["RunStatus"];

/** Ends without a judgement never look like a passed run. */
const LOOKS: Readonly<Record<Status, MarkLook>> = {
  queued: { sign: "○", tone: "quiet", text: "queued" },
  running: { sign: "▸", tone: "live", text: "running" },
  finished: { sign: "✓", tone: "good", text: "finished" },
  invalid: { sign: "⊘", tone: "lost", text: "invalid" },
  agent_failed: { sign: "✕", tone: "bad", text: "ADS failed" },
  plugin_failed: { sign: "⚠", tone: "lost", text: "plug-in failed" },
  simulator_crashed: { sign: "⚠", tone: "lost", text: "simulator crashed" },
  timed_out: { sign: "⚠", tone: "lost", text: "timed out" },
  infrastructure_failed: { sign: "⚠", tone: "lost", text: "lost to the infrastructure" },
  cancelled: { sign: "–", tone: "quiet", text: "cancelled" },
};

export const STATUSES = Object.keys(LOOKS) as readonly Status[];

/** States of runs that ended without a judgement, other than by a cancellation. */
export const NOT_JUDGED: readonly Status[] = [
  "agent_failed",
  "plugin_failed",
  "simulator_crashed",
  "timed_out",
  "infrastructure_failed",
  "invalid",
];

/** What the states are called on every screen. */
export const STATUS_WORDS = Object.fromEntries(
  STATUSES.map((status) => [status, LOOKS[status].text]),
) as Readonly<Record<Status, string>>;

/** Returns how a state is shown. */
export function lookOfStatus(status: Status): MarkLook {
  return LOOKS[status];
}

/** What a violation is called after its strongest accountability. */
const VIOLATED: Readonly<Record<Schemas["Accountability"], MarkLook>> = {
  avoidable: { sign: "✕", tone: "bad", text: "violated, avoidable" },
  not_measurable: { sign: "✕", tone: "bad", text: "violated, at fault" },
  unavoidable: { sign: "✕", tone: "bad", text: "violated, unavoidable" },
  undetermined: { sign: "✕", tone: "lost", text: "violated, undetermined" },
  not_judged: { sign: "✕", tone: "lost", text: "violated" },
  preventable: { sign: "✕", tone: "lost", text: "violated, not at fault, but avoidable" },
  not_at_fault: { sign: "✕", tone: "lost", text: "violated, not at fault" },
};

/** Returns how a run's state is shown: a finished run by what its oracles found. */
export function lookOfRun(run: Schemas["RunSummary"]): MarkLook {
  if (run.status !== "finished") return LOOKS[run.status];
  if (run.violations === 0) return { sign: "✓", tone: "good", text: "passed" };
  if (run.violations === null || run.violations === undefined) return LOOKS.finished;
  if (run.accountability) return VIOLATED[run.accountability];
  return run.at_fault_violations
    ? { sign: "✕", tone: "bad", text: "violated, at fault" }
    : { sign: "✕", tone: "lost", text: "violated" };
}
