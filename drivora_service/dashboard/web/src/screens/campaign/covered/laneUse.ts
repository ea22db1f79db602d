import type { Schemas } from "../../../api/client";
import { type Bounds, boundsOf } from "../../../components/charts/placeMap";
import { type FlatLine, lengthOf, partOf } from "../../../roads/lines";

type Lane = Schemas["LaneCoverage"];

/** Actors whose use of the roads is shown. */
export const USES = ["egos", "actors"] as const;
export type Use = (typeof USES)[number];

/** Parts of a network that a map shows. */
export const AREAS = ["used", "network"] as const;
export type Area = (typeof AREAS)[number];

/** Neighbouring pieces of a lane that look the same. */
export interface Run {
  readonly shade: number;
  readonly line: FlatLine;
}

/** Returns the used runs of a lane whose pieces, from its begin, are equally long. */
export function runsOf(
  line: FlatLine,
  counts: readonly number[],
  shadeOf: (count: number) => number | undefined,
): readonly Run[] {
  const piece = lengthOf(line) / counts.length;
  const found: Run[] = [];
  let begin = 0;
  for (let place = 1; place <= counts.length; place++) {
    const shade = shadeOf(counts[begin] ?? 0);
    if (place < counts.length && shadeOf(counts[place] ?? 0) === shade) continue;
    if (shade !== undefined)
      found.push({ shade, line: partOf(line, begin * piece, place * piece) });
    begin = place;
  }
  return found;
}

/** A piece of a lane with its counts. */
export interface Piece {
  /** Place along the lane, from 0. */
  readonly place: number;
  /** Metres from the lane's begin. */
  readonly from: number;
  readonly to: number;
  readonly egos: number;
  readonly actors: number;
}

/** Returns the pieces of a lane that is so long. */
export function piecesOf({ egos, actors }: Lane, length: number): readonly Piece[] {
  const piece = length / actors.length;
  return actors.map((count, place) => ({
    place,
    from: place * piece,
    to: (place + 1) * piece,
    egos: egos[place] ?? 0,
    actors: count,
  }));
}

/** Returns the piece at a distance along a lane that is so long. */
export function pieceAt(lane: Lane, length: number, along: number): Piece | undefined {
  const pieces = piecesOf(lane, length);
  const place = Math.floor((along / length) * pieces.length);
  return pieces[Math.min(Math.max(place, 0), pieces.length - 1)];
}

/** Metres around what is shown at least: the whole width of the road, and its neighbours. */
const LEAST_ROOM_M = 12;

/**
 * Returns the part of the plane around all used pieces and other places; undefined without any.
 *
 * The room around them is a share of their extent.
 */
export function usedBounds(
  lanes: readonly Lane[],
  use: Use,
  lineOf: (lane: string) => FlatLine | undefined,
  places: readonly (readonly number[])[],
  room: number,
): Bounds | undefined {
  const points = [...places];
  for (const lane of lanes) {
    const line = lineOf(lane.lane);
    if (!line) continue;
    for (const run of runsOf(line, lane[use], (count) => (count > 0 ? 0 : undefined)))
      for (let i = 0; i + 1 < run.line.length; i += 2)
        points.push([run.line[i] ?? 0, run.line[i + 1] ?? 0]);
  }
  const [left, bottom, right, top] = boundsOf(points, 0) ?? [0, 0, 0, 0];
  return boundsOf(points, Math.max(room * Math.max(right - left, top - bottom), LEAST_ROOM_M));
}
