import type { JsonObject } from "../../components/fields/pointers";

const MOST = 200;

/** The states of a document that is written, one of them now. */
export interface History {
  readonly past: readonly JsonObject[];
  readonly now: JsonObject;
  readonly future: readonly JsonObject[];
  /** How often another document was opened. */
  readonly opened: number;
  /** What the last change was of: changes of the same are one step back. */
  readonly last: string;
}

export type HistoryAction =
  | { readonly do: "change"; readonly to: JsonObject; readonly of: string }
  | { readonly do: "undo" | "redo" }
  /** Begins with another document. */
  | { readonly do: "open"; readonly document: JsonObject };

export function historyOf(document: JsonObject): History {
  return { past: [], now: document, future: [], opened: 0, last: "" };
}

export function nextHistory(history: History, action: HistoryAction): History {
  const { past, now, future, opened } = history;
  switch (action.do) {
    case "open":
      return {
        past: [...past, now].slice(-MOST),
        now: action.document,
        future: [],
        opened: opened + 1,
        last: "",
      };
    case "change": {
      if (action.to === now) return history;
      const merged = action.of !== "" && action.of === history.last;
      return {
        past: merged ? past : [...past, now].slice(-MOST),
        now: action.to,
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
