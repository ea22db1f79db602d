import type { Schemas } from "../../api/client";

/** Statuses of runs that have no result which a replay could be compared with. */
const WITHOUT_RESULT: ReadonlySet<Schemas["RunStatus"]> = new Set([
  "queued",
  "running",
  "cancelled",
  "infrastructure_failed",
]);

/** Returns the command that runs a run again on a service, and compares both bit for bit. */
export function replayCommand(id: string, server: string): string {
  return `drivora replay ${id} --server ${server}`;
}

/** Returns the command that runs a run again; one without a result is only driven again. */
export function againCommand(
  { id, status, cause }: Pick<Schemas["Run"], "id" | "status" | "cause">,
  server: string,
): string {
  if (!WITHOUT_RESULT.has(status) && cause !== "quarantined") return replayCommand(id, server);
  return `drivora runs scenario ${id} --server ${server} --out ${id}.json && drivora run ${id}.json`;
}

/** Returns the command that judges a run by today's oracles; "" if these have judged it. */
export function rejudgeCommand(
  { id, judged_by_other_oracles }: Pick<Schemas["Run"], "id" | "judged_by_other_oracles">,
  server: string,
): string {
  return judged_by_other_oracles ? `drivora rejudge ${id} --server ${server}` : "";
}
