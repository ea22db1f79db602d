import { useCallback, useEffect, useReducer, useRef } from "react";
import { isObject, type Json, type JsonObject, withValue } from "../../components/fields/pointers";
import { keepEarlier } from "./earlier";
import { historyOf, nextHistory, type Written } from "./history";
import { type Origin, originWords, readOrigin } from "./origin";
import { townOf } from "./scenario";

const KEY = "drivora:draft";
const ORIGIN_KEY = "drivora:draft-origin";
const SETTLED_MS = 300;

/** The scenario that is written: this browser keeps it. */
export interface Draft {
  readonly scenario: JsonObject;
  /** What it was opened from; undefined of one that began with a network. */
  readonly origin: Origin | undefined;
  /** Its name in lists of runs. */
  readonly name: string;
  /** How often another document was opened. */
  readonly opened: number;
  readonly canUndo: boolean;
  readonly canRedo: boolean;
  /** Changes the document; changes of the same thing are one step back. */
  readonly change: (to: JsonObject, of?: string) => void;
  readonly set: (pointer: string, value: Json | undefined) => void;
  /** Begins with another document. */
  readonly open: (document: JsonObject, origin?: Origin, isEdited?: boolean) => void;
  /** Takes another document in place of this one; a step back leads to this one. */
  readonly replace: (document: JsonObject, origin?: Origin) => void;
  readonly undo: () => void;
  readonly redo: () => void;
}

export function useDraft(): Draft {
  const [history, act] = useReducer(nextHistory, undefined, () => historyOf(storedDraft()));
  const { now } = history;
  useEffect(() => {
    const timer = setTimeout(() => {
      const { document, origin, isEdited } = now;
      try {
        localStorage.setItem(KEY, JSON.stringify(document));
        localStorage.setItem(ORIGIN_KEY, JSON.stringify({ ...origin, isEdited }));
      } catch {
        // A document that is too long for the browser is kept while the page is open.
      }
    }, SETTLED_MS);
    return () => clearTimeout(timer);
  }, [now]);
  const change = useCallback((to: JsonObject, of = "") => act({ do: "change", to, of }), []);
  const latest = useRef(now);
  latest.current = now;
  const open = useCallback((document: JsonObject, origin?: Origin, isEdited = false) => {
    keepEarlier(latest.current);
    act({ do: "open", written: { document, origin, isEdited } });
  }, []);
  const replace = useCallback((document: JsonObject, origin?: Origin) => {
    keepEarlier(latest.current);
    act({ do: "replace", written: { document, origin, isEdited: false } });
  }, []);
  const { document, origin, isEdited } = now;
  return {
    scenario: document,
    origin,
    name: origin ? originWords(origin, isEdited) : `draft on ${townOf(document)}`,
    opened: history.opened,
    canUndo: history.past.length > 0,
    canRedo: history.future.length > 0,
    change,
    set: (pointer, value) => change(withValue(document, pointer, value), pointer),
    open,
    replace,
    undo: () => act({ do: "undo" }),
    redo: () => act({ do: "redo" }),
  };
}

function storedDraft(): Written {
  const document = stored(KEY);
  const about = stored(ORIGIN_KEY);
  return { document, origin: readOrigin(about), isEdited: about.isEdited === true };
}

function stored(key: string): JsonObject {
  try {
    const found: unknown = JSON.parse(localStorage.getItem(key) ?? "{}");
    return isObject(found) ? found : {};
  } catch {
    return {};
  }
}
