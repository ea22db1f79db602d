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

/** Returns how a run's state is shown: a finished run by what its oracles found. */
export function lookOfRun(run: Schemas["RunSummary"]): MarkLook {
  if (run.status !== "finished") return LOOKS[run.status];
  if (run.violations === 0) return { sign: "✓", tone: "good", text: "passed" };
  if (run.violations === null || run.violations === undefined) return LOOKS.finished;
  return run.at_fault_violations
    ? { sign: "✕", tone: "bad", text: "violated, at fault" }
    : { sign: "✕", tone: "lost", text: "violated" };
}
