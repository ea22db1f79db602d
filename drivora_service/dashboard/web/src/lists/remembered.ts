import { useCallback, useSyncExternalStore } from "react";

const watchers = new Set<() => void>();

function watch(changed: () => void): () => void {
  watchers.add(changed);
  window.addEventListener("storage", changed);
  return () => {
    watchers.delete(changed);
    window.removeEventListener("storage", changed);
  };
}

/** A value that this browser remembers, the same in all tabs; `null` forgets it. */
export function useRemembered<T>(
  key: string,
  read: (stored: unknown) => T,
): [T, (value: T | null) => void] {
  const text = useSyncExternalStore(watch, () => localStorage.getItem(key));
  const set = useCallback(
    (value: T | null) => {
      if (value === null) localStorage.removeItem(key);
      else localStorage.setItem(key, JSON.stringify(value));
      for (const watcher of watchers) watcher();
    },
    [key],
  );
  return [read(parsed(text)), set];
}

/** What another version of the page stored may be anything. */
function parsed(text: string | null): unknown {
  if (text === null) return undefined;
  try {
    return JSON.parse(text);
  } catch {
    return undefined;
  }
}
