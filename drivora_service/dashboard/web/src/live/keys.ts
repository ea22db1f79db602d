import type { Change } from "./messages";

/** Stands for all queries, where what has changed cannot be told. */
export const EVERYTHING = "everything";

/** Returns the queries that a change touches: `kind id` and `kind list`, also of what it belongs to. */
export function touches(change: Change): readonly string[] {
  const found = [`${change.kind} ${change.id}`, `${change.kind} list`];
  if (change.batch_id) found.push(`batch ${change.batch_id}`, "batch list");
  if (change.campaign_id) found.push(`campaign ${change.campaign_id}`, "campaign list");
  if (change.study_id) found.push(`study ${change.study_id}`, "study list");
  return found;
}
