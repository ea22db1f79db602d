import { useQuery } from "@tanstack/react-query";
import { useMemo } from "react";
import type { Clock } from "./clock";
import { differenceOf, firstParting, type Pace, timesOfOther } from "./difference";
import { Follower } from "./follower";
import type { Recording } from "./recording";
import { runQuery } from "./runQuery";
import { useRecording } from "./useRecording";

/** A second run in step with the first; its actors of the same names are compared. */
export function useSecondRun(first: Recording, clock: Clock, id: string, ego: number, pace: Pace) {
  const run = useQuery(runQuery(id));
  const { recording, loaded, error } = useRecording(run.data?.trace_sha256 ? id : "");
  const whole = recording !== undefined && loaded >= recording.steps;
  const firstWhole = first.loaded >= first.steps;
  const compared = useMemo(() => {
    if (!recording || !whole || !firstWhole || recording.network !== first.network)
      return undefined;
    const name = first.actors[ego]?.id;
    const same = recording.actors.slice(0, recording.egos).findIndex((one) => one.id === name);
    const other = same < 0 ? 0 : same;
    const times = timesOfOther(first, recording, ego, other, pace);
    return {
      recording,
      moment: new Follower(clock, times, recording.stepLength),
      parting: firstParting(first, recording),
      difference: differenceOf(first, recording, ego, other, times),
    };
  }, [first, recording, whole, firstWhole, clock, ego, pace]);
  const failure =
    run.error ??
    error ??
    (run.data && !run.data.trace_sha256 ? new Error("it has no recording") : undefined) ??
    (recording && recording.network !== first.network
      ? new Error(`it was driven on ${recording.network}, not on ${first.network}`)
      : undefined);
  return { run: run.data, compared, failure };
}
