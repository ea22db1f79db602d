import { useEffect, useState } from "react";
import type { Draft, Kind } from "./draft";

interface Kept {
  readonly source: string;
  readonly draft: Draft;
}

const keyOf = (kind: Kind) => `drivora:draft:${kind}`;

/**
 * Keeps a draft in the tab, so that it is there after a look at another screen or a reload.
 *
 * What was kept from another beginning is not shown, and is lost with the first change.
 */
export function useDraft(kind: Kind, source: string, beginning: Draft) {
  const [draft, setDraft] = useState<Draft>(() => kept(kind, source) ?? beginning);
  useEffect(() => {
    if (draft === beginning) return;
    try {
      sessionStorage.setItem(keyOf(kind), JSON.stringify({ source, draft } satisfies Kept));
    } catch {
      // Too large to be kept: the form works without.
      sessionStorage.removeItem(keyOf(kind));
    }
  }, [kind, source, draft, beginning]);
  return {
    draft,
    change: setDraft,
    isChanged: draft !== beginning,
    /** Begins again. */
    discard: () => {
      sessionStorage.removeItem(keyOf(kind));
      setDraft(beginning);
    },
  };
}

/** Forgets what is kept, once it was started. */
export function forgetDraft(kind: Kind): void {
  sessionStorage.removeItem(keyOf(kind));
}

function kept(kind: Kind, source: string): Draft | undefined {
  try {
    const text = sessionStorage.getItem(keyOf(kind));
    const found = text ? (JSON.parse(text) as Kept) : undefined;
    return found?.source === source ? found.draft : undefined;
  } catch {
    return undefined;
  }
}
