import { useNavigate } from "@tanstack/react-router";
import { useEffect, useMemo } from "react";

const SETTLED_MS = 350;

type Changes = Readonly<Record<string, string | readonly string[] | undefined>>;

/** Returns a function that changes the address: at once, or when nothing has changed for a moment. */
export function useAddressWriter() {
  const navigate = useNavigate();
  const put = useMemo(() => {
    let waiting: Changes = {};
    let timer: ReturnType<typeof setTimeout> | undefined;
    return (changes: Changes, at_once = false) => {
      waiting = { ...waiting, ...changes };
      clearTimeout(timer);
      const write = () => {
        const changed = waiting;
        waiting = {};
        const search = (before: object) => ({ ...before, ...changed });
        void navigate({ to: ".", search, replace: true, resetScroll: false });
      };
      if (at_once) write();
      else timer = setTimeout(write, SETTLED_MS);
      return () => clearTimeout(timer);
    };
  }, [navigate]);
  // What waits is not written into the address of another screen.
  useEffect(() => () => put({})(), [put]);
  return put;
}
