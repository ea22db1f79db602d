import type { Schemas } from "../../api/client";
import type { MarkLook } from "../../components/Mark";
import { count } from "../../components/numbers";

export type Workers = Schemas["Workers"];
export type Slot = Schemas["WorkerSlot"];

const LOOKS: Readonly<Record<Slot["state"], MarkLook>> = {
  starting: { sign: "◌", tone: "quiet", text: "starting" },
  idle: { sign: "○", tone: "quiet", text: "idle" },
  running: { sign: "▸", tone: "live", text: "running" },
};

export function lookOfSlot(slot: Slot): MarkLook {
  return LOOKS[slot.state];
}

/** Returns what a slot does in detail, where that says more than its state. */
export function phaseOf({ phase, state }: Slot): string {
  return phase === state ? "" : phase.replaceAll("_", " ");
}

/** Returns for how many seconds a slot has done the same; `undefined` if it is not known. */
export function secondsSince({ since }: Slot, now: number): number | undefined {
  return since ? Math.max(0, (now - Date.parse(since)) / 1000) : undefined;
}

/** Returns how things stand with the workers, in a sentence. */
export function standing({ slots, queue }: Workers): string {
  const busy = slots.filter(({ state }) => state === "running").length;
  const waiting = queue.reduce((sum, { queued }) => sum + queued, 0);
  const paused = queue.reduce((sum, part) => sum + part.paused, 0);
  const parts = [
    slots.length === 0 ? "No worker" : `${count(busy)} of ${count(slots.length)} workers run`,
    waiting === 0
      ? "no run waits"
      : `${count(waiting)} ${waiting === 1 ? "run waits" : "runs wait"}`,
  ];
  if (paused > 0) parts.push(`${count(paused)} paused`);
  return parts.join(", ");
}

/** Returns memory as whole megabytes. */
export function megabytes(bytes: number): string {
  return bytes > 0 ? count(bytes / 1e6) : "";
}
