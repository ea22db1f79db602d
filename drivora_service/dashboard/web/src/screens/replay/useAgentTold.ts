import { useQuery } from "@tanstack/react-query";
import { type RecordBatch, RecordBatchReader } from "apache-arrow";
import { problemOf } from "../../api/client";
import { addressOf } from "../../service";
import { AgentTold } from "./plans";
import type { Recording } from "./recording";

const LOG = "log:";

/** The planned paths and logged numbers of a run's agents, read after the recording itself. */
export function useAgentTold(run: string, recording: Recording, wanted: boolean) {
  return useQuery({
    queryKey: ["run", run, "told by agents"],
    queryFn: async ({ signal }) => {
      const answer = await fetch(addressOf(`/api/v1/runs/${run}/observations?rows=egos`), {
        headers: { Accept: "application/vnd.apache.arrow.stream" },
        signal,
      });
      if (!answer.ok) throw await problemOf(answer);
      const told = new AgentTold(recording.stepLength, recording.steps);
      for await (const batch of await RecordBatchReader.from(answer)) addBatch(told, batch);
      return told;
    },
    enabled: wanted,
    structuralSharing: false,
  });
}

function addBatch(told: AgentTold, batch: RecordBatch): void {
  const numbers = (name: string) =>
    batch.getChild(name)?.data[0]?.values as ArrayLike<number> | undefined;
  const [steps, egos] = [numbers("step"), numbers("actor")];
  if (!steps || !egos) return;
  for (const { name } of batch.schema.fields) {
    if (!name.startsWith(LOG)) continue;
    const values = numbers(name);
    for (let k = 0; values && k < batch.numRows; k++)
      told.addValue(name.slice(LOG.length), egos[k] ?? 0, steps[k] ?? 0, values[k] ?? Number.NaN);
  }
  const plans = batch.getChild("plan")?.data[0];
  const points = plans?.children[0]?.values as Float32Array | undefined;
  const offsets = plans?.valueOffsets as Int32Array | undefined;
  if (!points || !offsets) return;
  for (let k = 0; k < batch.numRows; k++) {
    const [from, to] = [offsets[k] ?? 0, offsets[k + 1] ?? 0];
    if (to > from)
      told.addPlan(egos[k] ?? 0, { step: steps[k] ?? 0, points: points.slice(from, to) });
  }
}
