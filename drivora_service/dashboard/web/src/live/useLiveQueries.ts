import { useQueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import { listen } from "./hub";
import { touches } from "./keys";

const GATHER_MS = 300;

/** Asks anew for whatever a change touches: keys of queries are `[kind, id or "list", …]`. */
export function useLiveQueries(): void {
  const queries = useQueryClient();
  useEffect(() => {
    let touched = new Set<string>();
    let timer: ReturnType<typeof setTimeout> | undefined;
    const renew = () => {
      timer = undefined;
      const keys = touched;
      touched = new Set();
      void queries.invalidateQueries({
        predicate: ({ queryKey: [kind, id] }) =>
          keys.has("everything") || keys.has(`${kind} ${id}`),
      });
    };
    const stop = listen((told) => {
      if (told.type === "reset") touched.add("everything");
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
