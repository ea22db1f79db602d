import { useEffect, useState } from "react";
import { Problem, type Schemas } from "../../api/client";
import type { JsonObject } from "../../components/fields/pointers";

const PAUSE_MS = 350;

/** What the service says of a document. */
export interface Validation<Answer> {
  /** The answer, if it can be started. */
  readonly answer: Answer | undefined;
  readonly problems: readonly Schemas["ProblemItem"][];
  /** Why it could not be checked. */
  readonly error: Error | undefined;
  /** Whether it is of the present document, and not of one before. */
  readonly isFresh: boolean;
  readonly again: () => void;
}

interface Checked<Answer> {
  readonly document: JsonObject | undefined;
  readonly answer?: Answer;
  readonly problems: readonly Schemas["ProblemItem"][];
  readonly error?: Error;
}

/**
 * Has the service check a document shortly after it has changed; `undefined` is not checked.
 *
 * What it said of the document before stays until it has answered, so that nothing flickers.
 */
export function useValidation<Answer>(
  document: JsonObject | undefined,
  ask: (document: JsonObject, signal: AbortSignal) => Promise<Answer>,
): Validation<Answer> {
  const [checked, setChecked] = useState<Checked<Answer>>({ document: undefined, problems: [] });
  const [turn, setTurn] = useState(0);
  // biome-ignore lint/correctness/useExhaustiveDependencies: another turn asks again
  useEffect(() => {
    if (!document) return;
    const stop = new AbortController();
    const check = async () => {
      const result = await resultOf(document, ask, stop.signal);
      if (!stop.signal.aborted) setChecked(result);
    };
    const timer = setTimeout(() => void check(), PAUSE_MS);
    return () => {
      clearTimeout(timer);
      stop.abort();
    };
  }, [document, ask, turn]);
  const { answer, problems, error } = document ? checked : { problems: [] };
  return {
    answer,
    problems,
    error,
    isFresh: document !== undefined && checked.document === document,
    again: () => setTurn(turn + 1),
  };
}

async function resultOf<Answer>(
  document: JsonObject,
  ask: (document: JsonObject, signal: AbortSignal) => Promise<Answer>,
  signal: AbortSignal,
): Promise<Checked<Answer>> {
  try {
    return { document, answer: await ask(document, signal), problems: [] };
  } catch (error) {
    if (error instanceof Problem && error.problems.length > 0)
      return { document, problems: error.problems };
    return {
      document,
      problems: [],
      error: error instanceof Error ? error : new Error(`${error}`),
    };
  }
}
