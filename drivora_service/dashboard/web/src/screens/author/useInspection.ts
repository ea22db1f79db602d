import { useEffect, useRef, useState } from "react";
import { api, body, type Schemas } from "../../api/client";
import type { JsonObject } from "../../components/fields/pointers";

export interface Inspected {
  /** What the service last said; of an older state of the document for a moment. */
  readonly inspection: Schemas["Inspection"] | undefined;
  /** The document that it was said of. */
  readonly of: JsonObject | undefined;
  readonly error: unknown;
}

/** Asks the service about each state of a document; one question at a time, the newest next. */
export function useInspection(document: JsonObject | undefined): Inspected {
  const [told, setTold] = useState<Inspected>({
    inspection: undefined,
    of: undefined,
    error: undefined,
  });
  const wanted = useRef<JsonObject>(undefined);
  const asking = useRef(false);
  const here = useRef(true);
  useEffect(() => {
    here.current = true;
    return () => {
      here.current = false;
    };
  }, []);
  useEffect(() => {
    wanted.current = document;
    if (asking.current || !document) return;
    const ask = async () => {
      asking.current = true;
      while (wanted.current && here.current) {
        const of: JsonObject = wanted.current;
        wanted.current = undefined;
        try {
          const answer = await api.POST("/api/v1/scenarios:inspect", {
            body: of as unknown as Schemas["ScenarioDocument"],
          });
          setTold({ inspection: body(answer), of, error: undefined });
        } catch (error) {
          setTold((before) => ({ ...before, error }));
        }
      }
      asking.current = false;
    };
    void ask();
  }, [document]);
  return told;
}
