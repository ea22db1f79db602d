import type { Schemas } from "../api/client";
import { type FlatLine, flat, footOn, isInside } from "./lines";

type Lane = Schemas["LaneGeometry"];

/** A place on a lane. */
export interface LanePlace {
  readonly lane: Lane;
  /** Metres along its centre line. */
  readonly offset: number;
  /** Metres beside it, positive to the left. */
  readonly lateral: number;
}

const CELL_M = 25;

/** Finds lanes by place: only those of a cell of the plane are looked at. */
export class LaneIndex {
  readonly byId = new Map<string, Lane>();
  private readonly lines = new Map<Lane, FlatLine>();
  private readonly cells = new Map<string, Lane[]>();

  constructor(lanes: readonly Lane[]) {
    for (const lane of lanes) {
      this.byId.set(lane.id, lane);
      const line = flat(lane.shape);
      this.lines.set(lane, line);
      for (const cell of cellsOf(line, lane.width)) {
        const found = this.cells.get(cell);
        if (found) found.push(lane);
        else this.cells.set(cell, [lane]);
      }
    }
  }

  lineOf(lane: Lane): FlatLine {
    return this.lines.get(lane) ?? [];
  }

  /**
   * Returns the lane at a place: of several, the one whose centre is nearest for its width.
   *
   * Lanes that are not wanted are passed over.
   */
  at(x: number, y: number, wanted: (lane: Lane) => boolean = () => true): LanePlace | undefined {
    let best: LanePlace | undefined;
    let bestShare = Number.POSITIVE_INFINITY;
    for (const lane of this.cells.get(cellAt(x, y)) ?? []) {
      if (!wanted(lane)) continue;
      const line = this.lineOf(lane);
      const foot = footOn(line, x, y);
      // The outline of a walking area is all of it; other lanes are strips around their line.
      const share =
        lane.kind === "walking_area"
          ? isInside(line, x, y)
            ? 0.99
            : Number.POSITIVE_INFINITY
          : foot.distance / (0.5 * lane.width);
      if (share <= 1 && share < bestShare) {
        best = { lane, offset: foot.along, lateral: foot.lateral };
        bestShare = share;
      }
    }
    return best;
  }
}

function cellAt(x: number, y: number): string {
  return `${Math.floor(x / CELL_M)} ${Math.floor(y / CELL_M)}`;
}

function cellsOf(line: FlatLine, width: number): ReadonlySet<string> {
  const found = new Set<string>();
  for (let i = 0; i + 3 < line.length || i === 0; i += 2) {
    const xs = [line[i] ?? 0, line[i + 2] ?? line[i] ?? 0];
    const ys = [line[i + 1] ?? 0, line[i + 3] ?? line[i + 1] ?? 0];
    const pieces = Math.max(1, Math.ceil(Math.hypot(span(xs), span(ys)) / CELL_M));
    for (let piece = 0; piece <= pieces; piece++) {
      const x = (xs[0] ?? 0) + ((xs[1] ?? 0) - (xs[0] ?? 0)) * (piece / pieces);
      const y = (ys[0] ?? 0) + ((ys[1] ?? 0) - (ys[0] ?? 0)) * (piece / pieces);
      for (const dx of [-width, 0, width])
        for (const dy of [-width, 0, width]) found.add(cellAt(x + dx, y + dy));
    }
  }
  return found;
}

function span(values: readonly number[]): number {
  return Math.max(...values) - Math.min(...values);
}
