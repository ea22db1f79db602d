import { useEffect, useSyncExternalStore } from "react";
import { Connection } from "./connection";
import type { Said, Told } from "./messages";

type Listener = (told: Told) => void;

const listeners = new Set<Listener>();
let live = false;
let started = false;
let say: (said: Said) => void = () => undefined;

function tell(told: Told): void {
  if (told.type === "state") live = told.live;
  for (const listener of listeners) listener(told);
}

function start(): void {
  if (started) return;
  started = true;
  if (typeof SharedWorker === "undefined") {
    const connection = new Connection(tell);
    say = (said) => said === "again" && connection.again();
    return;
  }
  const worker = new SharedWorker(new URL("./hub.worker.ts", import.meta.url), { type: "module" });
  worker.port.onmessage = (event: MessageEvent<Told>) => tell(event.data);
  worker.port.start();
  say = (said) => worker.port.postMessage(said);
  window.addEventListener("pagehide", () => say("gone"));
  window.addEventListener("pageshow", (event) => {
    if (event.persisted) window.location.reload();
  });
}

/** Calls a function with everything that the service tells. */
export function listen(listener: Listener): () => void {
  start();
  listeners.add(listener);
  return () => {
    listeners.delete(listener);
  };
}

/** Connects at once where there is no connection. */
export function connectAgain(): void {
  say("again");
}

/** Whether the service tells what changes at this time. */
export function useLive(): boolean {
  return useSyncExternalStore(listen, () => live);
}

export function useTold(listener: Listener): void {
  useEffect(() => listen(listener), [listener]);
}
