import type { Recording } from "./recording";

type Runs = Pick<
  Recording,
  "actors" | "egos" | "steps" | "stepLength" | "loaded" | "x" | "y" | "speed" | "routeS"
>;

/** Positions nearer than this are the same, metres. */
const SAME_M = 0.01;

/** The first moment at which two runs differ, and the actor that does. */
export interface Parting {
  readonly step: number;
  readonly time: number;
  readonly actor: string;
}

/** Returns the first step at which an actor of both runs is elsewhere, or is there in one only. */
export function firstParting(one: Runs, other: Runs): Parting | undefined {
  const rows = new Map(other.actors.map((actor, row) => [actor.id, row]));
  const steps = Math.min(one.loaded, other.loaded);
  for (let step = 0; step < steps; step++)
    for (let row = 0; row < one.actors.length; row++) {
      const actor = one.actors[row];
      const there = actor && rows.get(actor.id);
      if (!actor || there === undefined) continue;
      const a = step * one.actors.length + row;
      const b = step * other.actors.length + there;
      const apart = Math.hypot(
        (one.x[a] as number) - (other.x[b] as number),
        (one.y[a] as number) - (other.y[b] as number),
      );
      const alone = Number.isNaN(one.x[a]) !== Number.isNaN(other.x[b]);
      if (alone || apart > SAME_M) return { step, time: step * one.stepLength, actor: actor.id };
    }
  if (one.steps === other.steps || steps < Math.min(one.steps, other.steps)) return undefined;
  return { step: steps, time: steps * one.stepLength, actor: "" };
}

/** How two runs are kept in step: at the same time, or at the same distance along the route. */
export type Pace = "time" | "route";

/** Returns, for each step of a run, the time of another one that is shown with it. */
export function timesOfOther(
  one: Runs,
  other: Runs,
  ego: number,
  otherEgo: number,
  pace: Pace,
): Float64Array {
  const times = new Float64Array(one.steps);
  const end = (other.steps - 1) * other.stepLength;
  let step = 0;
  for (let k = 0; k < one.steps; k++) {
    if (pace === "time") {
      times[k] = Math.min(k * one.stepLength, end);
      continue;
    }
    const reached = one.routeS[k * one.egos + ego] as number;
    // A run that has come as far, or as far as it ever comes.
    while (
      !Number.isNaN(reached) &&
      step < other.loaded - 1 &&
      !((other.routeS[step * other.egos + otherEgo] as number) >= reached)
    )
      step++;
    times[k] = step * other.stepLength;
  }
  return times;
}

export interface Difference {
  /** Metres between the two egos. */
  readonly apart: Float64Array;
  /** Of the first less the second, m/s. */
  readonly speed: Float64Array;
}

/** Compares an ego of two runs, step by step. */
export function differenceOf(
  one: Runs,
  other: Runs,
  ego: number,
  otherEgo: number,
  times: Float64Array,
): Difference {
  const apart = new Float64Array(one.steps).fill(Number.NaN);
  const speed = new Float64Array(one.steps).fill(Number.NaN);
  for (let k = 0; k < one.steps; k++) {
    const there = Math.round((times[k] as number) / other.stepLength);
    // It stands at its end, for it is over: there is no distance to it any more.
    if (k > 0 && times[k] === times[k - 1] && there === other.steps - 1) break;
    const a = k * one.actors.length + ego;
    const b = there * other.actors.length + otherEgo;
    apart[k] = Math.hypot(
      (one.x[a] as number) - (other.x[b] as number),
      (one.y[a] as number) - (other.y[b] as number),
    );
    speed[k] = (one.speed[a] as number) - (other.speed[b] as number);
  }
  return { apart, speed };
}
