import type { Schemas } from "../../api/client";
import { type Box, cameraOf, type Size } from "../../roads/camera";
import type { Actor, Recording } from "./recording";
import { failuresOf, gravestFirst } from "./verdictWords";

/** What of a recording says where its actors are. */
export type Ways = Pick<Recording, "x" | "y" | "stepLength" | "loaded" | "egos" | "actors">;

/** Pixels of a metre from which on the shape of a car, its front and its lane can be seen. */
const LEGIBLE = 5;
const MARGIN_M = 12;
const LEAST_SIDE_M = 44;
/** Actors that come this near to an ego belong to what happens. */
const NEAR_M = 20;
/** Seconds from the opening moment on that are tried, the longest that is legible is shown. */
const AHEAD_S = [10, 7, 4, 2] as const;

interface Stretch {
  /** Steps, both included. */
  readonly first: number;
  readonly last: number;
}

/** Returns the box of the ways of all egos, from the first step to the last. */
export function wholeBox(ways: Ways): Box {
  return boxOf(ways, range(ways.egos), { first: 0, last: ways.loaded - 1 });
}

/**
 * Returns the box that a map shows when a replay opens: the ways of the egos and of the actors that
 * come near them, over the whole run if that is legible, else over the seconds that follow, last of
 * all those of one ego.
 *
 * `from` is the opening moment in seconds, `focus` the row of that ego.
 */
export function openingBox(ways: Ways, size: Size, from: number, focus: number): Box {
  const whole: Stretch = { first: 0, last: ways.loaded - 1 };
  const all = range(ways.egos);
  const first = Math.min(Math.floor(from / ways.stepLength + 1e-6), whole.last);
  const ahead = (seconds: number): Stretch => ({
    first,
    last: Math.min(first + Math.round(seconds / ways.stepLength), whole.last),
  });
  const [longest] = AHEAD_S;
  const stretches: readonly (readonly [readonly number[], Stretch])[] = [
    [all, whole],
    [all, ahead(longest)],
    ...AHEAD_S.map((seconds) => [[focus], ahead(seconds)] as const),
  ];
  let box = wholeBox(ways);
  for (const [egos, stretch] of stretches) {
    if (isEmpty(ways, egos, stretch)) continue;
    const near = nearTo(ways, egos, stretch);
    for (const rows of near.length > 0 ? [[...egos, ...near], egos] : [egos]) {
      box = boxOf(ways, rows, stretch);
      if (cameraOf(box, size).scale >= LEGIBLE) return box;
    }
  }
  return box;
}

/**
 * Returns the row of the ego that the map keeps in sight: the chosen one, else that of the gravest
 * violation, else the first.
 */
export function focusOf(
  actors: readonly Pick<Actor, "id">[],
  run: Pick<Schemas["Run"], "verdicts" | "failing_verdicts">,
  chosen: string,
): number {
  const failures = failuresOf(run);
  const [gravest] = gravestFirst(run.verdicts, failures);
  const isObserved = gravest?.severity === "observation" && !failures.includes(gravest);
  const ego = chosen || (isObserved ? "" : gravest?.ego);
  return Math.max(
    actors.findIndex(({ id }) => id === ego),
    0,
  );
}

function range(count: number): readonly number[] {
  return Array.from({ length: count }, (_, place) => place);
}

function isEmpty({ x, actors }: Ways, rows: readonly number[], { first, last }: Stretch): boolean {
  for (let step = first; step <= last; step++)
    if (rows.some((row) => !Number.isNaN(x[step * actors.length + row]))) return false;
  return true;
}

/** Returns the rows of other actors that come near to one of the egos in a stretch. */
function nearTo(ways: Ways, egos: readonly number[], { first, last }: Stretch): readonly number[] {
  const { x, y, actors, stepLength } = ways;
  const every = Math.max(1, Math.round(0.2 / stepLength));
  const found = new Set<number>();
  for (let step = first; step <= last; step += every) {
    const start = step * actors.length;
    for (let row = 0; row < actors.length; row++) {
      if (egos.includes(row) || found.has(row)) continue;
      const is = (ego: number) =>
        Math.hypot(
          (x[start + row] as number) - (x[start + ego] as number),
          (y[start + row] as number) - (y[start + ego] as number),
        ) < NEAR_M;
      if (egos.some(is)) found.add(row);
    }
  }
  return [...found];
}

function boxOf(ways: Ways, rows: readonly number[], { first, last }: Stretch): Box {
  const { x, y, actors } = ways;
  let [west, south, east, north] = [Infinity, Infinity, -Infinity, -Infinity];
  for (let step = first; step <= last; step++)
    for (const row of rows) {
      const cell = step * actors.length + row;
      const across = x[cell] as number;
      const along = y[cell] as number;
      if (Number.isNaN(across)) continue;
      west = Math.min(west, across);
      south = Math.min(south, along);
      east = Math.max(east, across);
      north = Math.max(north, along);
    }
  if (west > east) return [0, 0, LEAST_SIDE_M, LEAST_SIDE_M];
  const middle = [(west + east) / 2, (south + north) / 2] as const;
  const half = [
    Math.max(east - west + 2 * MARGIN_M, LEAST_SIDE_M) / 2,
    Math.max(north - south + 2 * MARGIN_M, LEAST_SIDE_M) / 2,
  ] as const;
  return [middle[0] - half[0], middle[1] - half[1], middle[0] + half[0], middle[1] + half[1]];
}
