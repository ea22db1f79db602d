import { useCallback, useEffect, useReducer, useRef } from "react";
import { isObject, type Json, type JsonObject, withValue } from "../../components/fields/pointers";
import { keepEarlier } from "./earlier";
import { historyOf, nextHistory } from "./history";

const KEY = "drivora:draft";
const SETTLED_MS = 300;

/** The scenario that is written: this browser keeps it. */
export interface Draft {
  readonly scenario: JsonObject;
  /** How often another document was opened. */
  readonly opened: number;
  readonly canUndo: boolean;
  readonly canRedo: boolean;
  /** Changes the document; changes of the same thing are one step back. */
  readonly change: (to: JsonObject, of?: string) => void;
  readonly set: (pointer: string, value: Json | undefined) => void;
  readonly open: (document: JsonObject) => void;
  readonly undo: () => void;
  readonly redo: () => void;
}

export function useDraft(): Draft {
  const [history, act] = useReducer(nextHistory, undefined, () => historyOf(storedDraft()));
  const { now } = history;
  useEffect(() => {
    const timer = setTimeout(() => {
      try {
        localStorage.setItem(KEY, JSON.stringify(now));
      } catch {
        // A document that is too long for the browser is kept while the page is open.
      }
    }, SETTLED_MS);
    return () => clearTimeout(timer);
  }, [now]);
  const change = useCallback((to: JsonObject, of = "") => act({ do: "change", to, of }), []);
  const latest = useRef(now);
  latest.current = now;
  const open = useCallback((document: JsonObject) => {
    keepEarlier(latest.current);
    act({ do: "open", document });
  }, []);
  return {
    scenario: now,
    opened: history.opened,
    canUndo: history.past.length > 0,
    canRedo: history.future.length > 0,
    change,
    set: (pointer, value) => change(withValue(now, pointer, value), pointer),
    open,
    undo: () => act({ do: "undo" }),
    redo: () => act({ do: "redo" }),
  };
}

function storedDraft(): JsonObject {
  try {
    const stored: unknown = JSON.parse(localStorage.getItem(KEY) ?? "{}");
    return isObject(stored) ? stored : {};
  } catch {
    return {};
  }
}
