import { useEffect, useRef, useState } from "react";
import { count } from "../../components/numbers";
import { fileNameOf } from "../../documents/files";
import { csvLines, storeFile } from "../../lists/csv";
import type { Page } from "../../lists/useList";
import type { Run } from "./columns";

/** What a line of the file has, in this order: names as in the API. */
const FIELDS = [
  "id",
  "status",
  "cause",
  "label",
  "batch_id",
  "item",
  "town",
  "agent",
  "configuration",
  "configuration_id",
  "seed",
  "violations",
  "at_fault_violations",
  "accountability",
  "observations",
  "steps",
  "sim_time_s",
  "wall_time_s",
  "attempts",
  "created_at",
  "started_at",
  "ended_at",
  "scenario_sha256",
  "trace_sha256",
] as const satisfies readonly (keyof Run)[];

/** Stores all runs of the filter as a file for a spreadsheet; a second press stops it. */
export function CsvButton({
  name,
  ask,
  total,
}: {
  /** What the file is called after. */
  readonly name: string;
  readonly ask: (pageToken: string | undefined) => Promise<Page<Run>>;
  readonly total: number | undefined;
}) {
  const [got, setGot] = useState<number>();
  const [error, setError] = useState("");
  const stopped = useRef(true);
  useEffect(
    () => () => {
      stopped.current = true;
    },
    [],
  );
  const store = async () => {
    stopped.current = false;
    setError("");
    const parts = [csvLines([FIELDS])];
    let token: string | undefined;
    let rows = 0;
    do {
      setGot(rows);
      const page = await ask(token);
      if (stopped.current) return;
      parts.push(csvLines(page.items.map((run) => FIELDS.map((field) => run[field]))));
      rows += page.items.length;
      token = page.next_page_token || undefined;
    } while (token);
    storeFile(`${fileNameOf(name)}.csv`, "text/csv;charset=utf-8", parts);
  };
  const press = () => {
    if (got !== undefined) {
      stopped.current = true;
      setGot(undefined);
      return;
    }
    void store()
      .catch((failure: unknown) =>
        setError(failure instanceof Error ? failure.message : String(failure)),
      )
      .finally(() => setGot(undefined));
  };
  return (
    <>
      {error && (
        <span role="alert" className="refusal">
          {error}
        </span>
      )}
      <button
        type="button"
        onClick={press}
        title="All runs of this filter as a file for a spreadsheet"
      >
        {got === undefined ? "CSV" : `Stop: ${count(got)} of ${count(total)}`}
      </button>
    </>
  );
}
