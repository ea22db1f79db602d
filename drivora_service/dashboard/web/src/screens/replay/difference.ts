import type { Recording } from "./recording";

type Runs = Pick<
  Recording,
  "actors" | "egos" | "steps" | "stepLength" | "loaded" | "x" | "y" | "speed" | "routeS"
>;

/** Positions nearer than this are the same, metres. */
const SAME_M = 0.01;
/** Parts of a step that are no more than rounding. */
const ROUNDING = 1e-6;

/** The first moment at which two runs differ, and what does. */
export interface Parting {
  readonly step: number;
  readonly time: number;
  /** The actor that differs; "" if one of the runs is over. */
  readonly actor: string;
  /** The only run that has the actor then, or that goes on; undefined: the actor is elsewhere. */
  readonly only?: "first" | "second";
  /** Whether the other run has the actor at another time. */
  readonly atOtherTime?: boolean;
}

/** Returns the first step at which an actor is elsewhere, or is there in one run only. */
export function firstParting(one: Runs, other: Runs): Parting | undefined {
  const rows = new Map(other.actors.map((actor, row) => [actor.id, row]));
  const pairs = one.actors.map(({ id }, row) => ({ id, row, there: rows.get(id) ?? -1 }));
  const known = new Set(one.actors.map(({ id }) => id));
  other.actors.forEach(({ id }, there) => {
    if (!known.has(id)) pairs.push({ id, row: -1, there });
  });
  const end = Math.min(endOf(one), endOf(other)) + ROUNDING;
  let step = 0;
  for (; step * one.stepLength <= end; step++) {
    const time = step * one.stepLength;
    for (const { id, row, there } of pairs) {
      const x = valueAt(one, one.x, row, time);
      const otherX = valueAt(other, other.x, there, time);
      const gone = Number.isNaN(x);
      if (gone && Number.isNaN(otherX)) continue;
      if (gone || Number.isNaN(otherX)) {
        const atOtherTime = gone ? isEverIn(one, row) : isEverIn(other, there);
        return { step, time, actor: id, only: gone ? "second" : "first", atOtherTime };
      }
      const y = valueAt(one, one.y, row, time) - valueAt(other, other.y, there, time);
      if (Math.hypot(x - otherX, y) > SAME_M) return { step, time, actor: id };
    }
  }
  const whole = one.loaded >= one.steps && other.loaded >= other.steps;
  const longer = endOf(one) - endOf(other);
  if (!whole || Math.abs(longer) <= ROUNDING) return undefined;
  return { step, time: step * one.stepLength, actor: "", only: longer > 0 ? "first" : "second" };
}

/** Returns when two runs part and how, in words of the page of the first one. */
export function partingWords({ time, actor, only, atOtherTime }: Parting): string {
  const when = `They part at ${time.toFixed(2)} s: `;
  const run = only === "first" ? "this run" : "the other run";
  if (!actor) return `${when}only ${run} goes on`;
  if (!only) return `${when}${actor} is elsewhere`;
  return `${when}only ${run} has ${actor}${atOtherTime ? " at that time" : ""}`;
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
  const last = lastDriven(other, otherEgo);
  const come = (step: number) => other.routeS[step * other.egos + otherEgo] as number;
  let step = 0;
  for (let k = 0; k < one.steps; k++) {
    if (pace === "time") {
      times[k] = Math.min(k * one.stepLength, end);
      continue;
    }
    const before = times[k - 1] ?? 0;
    const reached = one.routeS[k * one.egos + ego] as number;
    if (Number.isNaN(reached)) {
      times[k] = before;
      continue;
    }
    // A run that has come as far, or as far as it ever comes.
    while (step < last && !(come(step) >= reached)) step++;
    const behind = step > 0 ? come(step - 1) : Number.NaN;
    const share = (reached - behind) / (come(step) - behind);
    const within = share > 0 && share < 1 ? step - 1 + share : step;
    // An ego that rolls back does not turn the time of the other run back.
    times[k] = Math.max(within * other.stepLength, before);
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
  const end = lastDriven(other, otherEgo) * other.stepLength;
  for (let k = 0; k < one.steps; k++) {
    const time = times[k] as number;
    // It stands at its end, for it is over: there is no distance to it any more.
    if (k > 0 && time === times[k - 1] && time >= end - ROUNDING) break;
    const a = k * one.actors.length + ego;
    apart[k] = Math.hypot(
      (one.x[a] as number) - valueAt(other, other.x, otherEgo, time),
      (one.y[a] as number) - valueAt(other, other.y, otherEgo, time),
    );
    speed[k] = (one.speed[a] as number) - valueAt(other, other.speed, otherEgo, time);
  }
  return { apart, speed };
}

/** Returns the last step in which an ego is driven: one that has ended may stand there on. */
function lastDriven(run: Runs, ego: number): number {
  let step = run.loaded - 1;
  while (step > 0 && Number.isNaN(run.routeS[step * run.egos + ego])) step--;
  return step;
}

/** Returns the last time that is there of a run. */
function endOf(run: Runs): number {
  return (run.loaded - 1) * run.stepLength;
}

/** Returns a value of an actor at a time, between two steps in proportion; NaN while absent. */
function valueAt(run: Runs, values: Float32Array, row: number, time: number): number {
  if (row < 0) return Number.NaN;
  const count = run.actors.length;
  const at = Math.min(time / run.stepLength, run.loaded - 1);
  const step = Math.floor(at + ROUNDING);
  const here = values[step * count + row] ?? Number.NaN;
  const share = at - step;
  if (share <= ROUNDING) return here;
  return here + share * ((values[(step + 1) * count + row] ?? Number.NaN) - here);
}

function isEverIn(run: Runs, row: number): boolean {
  if (row < 0) return false;
  for (let cell = row; cell < run.x.length; cell += run.actors.length)
    if (!Number.isNaN(run.x[cell])) return true;
  return false;
}
