import { useEffect, useRef } from "react";

/** A key, or two one after the other (`g r`), and what it does. */
export interface KeyAction {
  readonly keys: string;
  readonly does: string;
  readonly run: (event: KeyboardEvent) => void;
}

interface Layer {
  actions: readonly KeyAction[];
}

const layers: Layer[] = [];
const SECOND_KEY_MS = 1200;
let first = "";
let firstAt = 0;

/** Returns all keys that work now; those of the newest part of the page come first. */
export function keysNow(): readonly KeyAction[] {
  return layers.toReversed().flatMap((layer) => layer.actions);
}

/** Makes keys work as long as the component is there. */
export function useKeys(actions: readonly KeyAction[]): void {
  const layer = useRef<Layer>({ actions });
  layer.current.actions = actions;
  useEffect(() => {
    const mine = layer.current;
    layers.push(mine);
    return () => {
      layers.splice(layers.indexOf(mine), 1);
    };
  }, []);
}

/** Returns the name of a key: `j`, `?`, `enter`, `shift+right`, `left`. */
export function nameOf(event: KeyboardEvent): string {
  const key = event.key === " " ? "space" : event.key.replace(/^Arrow/, "").toLowerCase();
  return event.shiftKey && key.length > 1 ? `shift+${key}` : key;
}

function isTyping(target: EventTarget | null | undefined): boolean {
  return (
    target instanceof HTMLElement &&
    (target.isContentEditable ||
      /^(TEXTAREA|SELECT)$/.test(target.tagName) ||
      (target instanceof HTMLInputElement && !/^(checkbox|radio|button)$/.test(target.type)))
  );
}

/** Buttons and links keep the keys that press them. */
function isPressing(event: KeyboardEvent): boolean {
  return (
    (event.key === "Enter" || event.key === " ") &&
    event.target instanceof HTMLElement &&
    event.target.closest("button, a[href], summary, [role=tab], input") !== null
  );
}

export function handleKey(event: KeyboardEvent): void {
  if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
  // Inside a shadow tree the event's target is its host.
  if (
    isTyping(event.composedPath()[0]) ||
    isPressing(event) ||
    document.querySelector("dialog[open]")
  )
    return;
  const name = nameOf(event);
  const both = event.timeStamp - firstAt < SECOND_KEY_MS ? `${first} ${name}` : "";
  const actions = keysNow();
  const found =
    actions.find((action) => action.keys === both) ??
    actions.find((action) => action.keys === name);
  first = found ? "" : name;
  firstAt = event.timeStamp;
  if (found) {
    event.preventDefault();
    found.run(event);
  }
}
