import { type QueryClient, useQueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import { listen } from "./hub";
import { EVERYTHING, touches } from "./keys";

const GATHER_MS = 300;

/** Asks anew for whatever a change touches: keys of queries are `[kind, id or "list", …]`. */
export function useLiveQueries(): void {
  const queries = useQueryClient();
  useEffect(() => {
    let touched = new Set<string>();
    let timer: ReturnType<typeof setTimeout> | undefined;
    const renew = () => {
      touched = renewTouched(queries, touched);
      timer = touched.size > 0 ? setTimeout(renew, GATHER_MS) : undefined;
    };
    const stop = listen((told) => {
      if (told.type === "reset") touched.add(EVERYTHING);
      else if (told.type === "workers") touched.add("workers list");
      else if (told.type === "changes")
        for (const change of told.changes) for (const key of touches(change)) touched.add(key);
      else return;
      timer ??= setTimeout(renew, GATHER_MS);
    });
    return () => {
      stop();
      clearTimeout(timer);
    };
  }, [queries]);
}

/**
 * Asks anew for the touched queries, and returns those to ask for later.
 *
 * An answer that is on its way is waited for: under load it would else never come. It may have been
 * made before the change, so that its query is asked for once more after it.
 */
export function renewTouched(queries: QueryClient, touched: ReadonlySet<string>): Set<string> {
  const later = new Set<string>();
  void queries.invalidateQueries({
    predicate: ({ queryKey: [kind, id], state }) => {
      const key = `${kind} ${id}`;
      if (!touched.has(EVERYTHING) && !touched.has(key)) return false;
      if (state.fetchStatus === "idle") return true;
      later.add(key);
      return false;
    },
  });
  return later;
}
