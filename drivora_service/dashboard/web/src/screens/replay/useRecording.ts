import { useEffect, useState } from "react";
import { readRecording } from "./readRecording";
import type { Recording } from "./recording";

export interface Loaded {
  readonly recording?: Recording;
  /** Steps that are there. */
  readonly loaded: number;
  readonly error?: unknown;
}

/** Loads a run's recording; "" is none. */
export function useRecording(run: string): Loaded {
  const [state, setState] = useState<Loaded>({ loaded: 0 });
  useEffect(() => {
    setState({ loaded: 0 });
    if (!run) return;
    const stop = new AbortController();
    readRecording(run, stop.signal, (recording) =>
      setState({ recording, loaded: recording.loaded }),
    ).catch((error: unknown) => {
      if (!stop.signal.aborted) setState((before) => ({ ...before, error }));
    });
    return () => stop.abort();
  }, [run]);
  return state;
}
