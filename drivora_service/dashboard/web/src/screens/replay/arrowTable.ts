import { RecordBatchReader } from "apache-arrow";
import { problemOf } from "../../api/client";

/** An answer in columns: numbers by name, NaN where a value is missing. */
export interface ArrowTable<Head> {
  readonly head: Head;
  readonly rows: number;
  readonly columns: ReadonlyMap<string, Float64Array>;
}

/** Reads an Arrow stream whose schema has a JSON document under `metadata`. */
export async function readArrow<Head>(
  address: string,
  metadata: string,
  signal: AbortSignal,
): Promise<ArrowTable<Head>> {
  const answer = await fetch(address, {
    headers: { Accept: "application/vnd.apache.arrow.stream" },
    signal,
  });
  if (!answer.ok) throw await problemOf(answer);
  const reader = await RecordBatchReader.from(answer);
  await reader.open();
  const text = reader.schema.metadata.get(metadata);
  if (!text) throw new Error(`the answer has no ${metadata}`);
  const parts = new Map<string, Float64Array[]>();
  let rows = 0;
  for await (const batch of reader) {
    rows += batch.numRows;
    for (const field of batch.schema.fields) {
      const values = batch.getChild(field.name)?.data[0]?.values as ArrayLike<number> | undefined;
      const found = parts.get(field.name) ?? [];
      found.push(Float64Array.from(values ?? []));
      parts.set(field.name, found);
    }
  }
  const columns = new Map<string, Float64Array>();
  for (const [name, found] of parts) columns.set(name, joined(found, rows));
  return { head: JSON.parse(text) as Head, rows, columns };
}

function joined(parts: readonly Float64Array[], rows: number): Float64Array {
  const whole = new Float64Array(rows);
  let at = 0;
  for (const part of parts) {
    whole.set(part, at);
    at += part.length;
  }
  return whole;
}
