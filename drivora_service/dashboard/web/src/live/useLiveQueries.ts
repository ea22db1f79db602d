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
    let asking = false;
    let timer: ReturnType<typeof setTimeout> | undefined;
    const renew = () => {
      timer = undefined;
      const keys = touched;
      touched = new Set();
      // An answer that is on its way is waited for: under load it would else never come. What
      // changed meanwhile is asked for after it.
      const asked = queries.invalidateQueries(
        {
          predicate: ({ queryKey: [kind, id] }) =>
            keys.has("everything") || keys.has(`${kind} ${id}`),
        },
        { cancelRefetch: false },
      );
      asking = true;
      void asked.finally(() => {
        asking = false;
        if (touched.size > 0) timer ??= setTimeout(renew, GATHER_MS);
      });
    };
    const stop = listen((told) => {
      if (told.type === "reset") touched.add("everything");
      else if (told.type === "workers") touched.add("workers list");
      else if (told.type === "changes")
        for (const change of told.changes) for (const key of touches(change)) touched.add(key);
      else return;
      if (!asking) timer ??= setTimeout(renew, GATHER_MS);
    });
    return () => {
      stop();
      clearTimeout(timer);
    };
  }, [queries]);
}
