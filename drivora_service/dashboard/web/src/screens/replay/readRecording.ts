import { RecordBatchReader } from "apache-arrow";
import { problemOf } from "../../api/client";
import { addressOf } from "../../service";
import { COLUMNS, EGO_COLUMNS, Recording } from "./recording";

/** Reads a run's recording; tells of each part that has come, the first with the first steps. */
export async function readRecording(
  run: string,
  signal: AbortSignal,
  onPart: (recording: Recording) => void,
): Promise<void> {
  const wanted = new URLSearchParams([...COLUMNS, ...EGO_COLUMNS].map((name) => ["column", name]));
  const answer = await fetch(addressOf(`/api/v1/runs/${run}/observations?${wanted}`), {
    headers: { Accept: "application/vnd.apache.arrow.stream" },
    signal,
  });
  if (!answer.ok) throw await problemOf(answer);
  const reader = await RecordBatchReader.from(answer);
  await reader.open();
  const head = reader.schema.metadata.get("drivora_trace");
  if (!head) throw new Error("the recording has no head");
  const recording = new Recording(JSON.parse(head));
  for await (const batch of reader) {
    recording.add(batch);
    onPart(recording);
    if (signal.aborted) return;
  }
}
