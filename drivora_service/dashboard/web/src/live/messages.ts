/** What the service tells, and what the tabs of the page tell the one connection. */

export type ChangeKind =
  | "run"
  | "batch"
  | "campaign"
  | "study"
  | "minimization"
  | "group"
  | "suite"
  | "workers";

export interface Change {
  readonly kind: ChangeKind;
  readonly id: string;
  readonly status?: string;
  readonly batch_id?: string;
  readonly campaign_id?: string;
  readonly study_id?: string;
}

export type Told =
  | { readonly type: "state"; readonly live: boolean }
  | { readonly type: "changes"; readonly changes: readonly Change[] }
  | { readonly type: "workers"; readonly workers: unknown }
  | { readonly type: "reset" };

/** What a tab tells the connection: that it is gone, or to connect at once. */
export type Said = "gone" | "again";

/** Reads a frame of `/events`. */
export function read(event: string, data: string): Told | undefined {
  if (event === "changes") {
    const told = JSON.parse(data) as { changes: readonly Change[] };
    return { type: "changes", changes: told.changes };
  }
  if (event === "workers") return { type: "workers", workers: JSON.parse(data) };
  if (event === "reset") return { type: "reset" };
  return undefined;
}
