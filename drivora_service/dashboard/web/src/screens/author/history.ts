import type { JsonObject } from "../../components/fields/pointers";
import type { Origin } from "./origin";

const MOST = 200;

/** A state of a document that is written. */
export interface Written {
  readonly document: JsonObject;
  /** What it was opened from; undefined of one that began with a network. */
  readonly origin: Origin | undefined;
  /** Whether it has been changed since. */
  readonly isEdited: boolean;
}

/** The states of a document that is written, one of them now. */
export interface History {
  readonly past: readonly Written[];
  readonly now: Written;
  readonly future: readonly Written[];
  /** How often another document was opened. */
  readonly opened: number;
  /** What the last change was of: changes of the same are one step back. */
  readonly last: string;
}

export type HistoryAction =
  | { readonly do: "change"; readonly to: JsonObject; readonly of: string }
  | { readonly do: "undo" | "redo" }
  /** Begins with another document, which has no way back. */
  | { readonly do: "open"; readonly written: Written }
  /** Takes another document in place of the one that is written; a step back leads to that. */
  | { readonly do: "replace"; readonly written: Written };

export function historyOf(now: Written): History {
  return { past: [], now, future: [], opened: 0, last: "" };
}

export function nextHistory(history: History, action: HistoryAction): History {
  const { past, now, future, opened } = history;
  switch (action.do) {
    case "open":
    case "replace":
      return {
        past: action.do === "open" ? [] : [...past, now].slice(-MOST),
        now: action.written,
        future: [],
        opened: opened + 1,
        last: "",
      };
    case "change": {
      if (action.to === now.document) return history;
      const merged = action.of !== "" && action.of === history.last;
      return {
        past: merged ? past : [...past, now].slice(-MOST),
        now: { ...now, document: action.to, isEdited: true },
        future: [],
        opened,
        last: action.of,
      };
    }
    case "undo": {
      const before = past.at(-1);
      if (!before) return history;
      return { past: past.slice(0, -1), now: before, future: [now, ...future], opened, last: "" };
    }
    case "redo": {
      const [after, ...rest] = future;
      if (!after) return history;
      return { past: [...past, now], now: after, future: rest, opened, last: "" };
    }
  }
}
