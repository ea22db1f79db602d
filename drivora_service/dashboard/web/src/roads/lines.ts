/** Lines as flat arrays: x and y in turn, metres. */
export type FlatLine = readonly number[];

export function flat(points: readonly (readonly number[])[]): number[] {
  const line: number[] = [];
  for (const [x, y] of points) line.push(x ?? Number.NaN, y ?? Number.NaN);
  return line;
}

export function lengthOf(line: FlatLine): number {
  let length = 0;
  for (let i = 2; i < line.length; i += 2) length += pieceLength(line, i);
  return length;
}

function at(line: FlatLine, i: number): number {
  return line[i] ?? Number.NaN;
}

function pieceLength(line: FlatLine, i: number): number {
  return Math.hypot(at(line, i) - at(line, i - 2), at(line, i + 1) - at(line, i - 1));
}

/** A point of a line and the direction there, radians. */
export interface Place {
  readonly x: number;
  readonly y: number;
  readonly heading: number;
}

/** Returns the point at a distance along a line; beyond its ends, the end. */
export function placeAt(line: FlatLine, distance: number): Place {
  let left = Math.max(distance, 0);
  for (let i = 2; i < line.length; i += 2) {
    const piece = pieceLength(line, i);
    if (left <= piece || i === line.length - 2) {
      const share = piece > 0 ? Math.min(left / piece, 1) : 0;
      const dx = at(line, i) - at(line, i - 2);
      const dy = at(line, i + 1) - at(line, i - 1);
      return {
        x: at(line, i - 2) + share * dx,
        y: at(line, i - 1) + share * dy,
        heading: Math.atan2(dy, dx),
      };
    }
    left -= piece;
  }
  return { x: at(line, 0), y: at(line, 1), heading: 0 };
}

/** Returns the part of a line between two distances along it, with the corners between them. */
export function partOf(line: FlatLine, from: number, to: number): number[] {
  const begin = placeAt(line, from);
  const end = placeAt(line, to);
  const found = [begin.x, begin.y];
  let along = 0;
  for (let i = 2; i < line.length; i += 2) {
    along += pieceLength(line, i);
    if (along >= to) break;
    if (along > from) found.push(at(line, i), at(line, i + 1));
  }
  found.push(end.x, end.y);
  return found;
}

/** Returns a line beside another one; positive is to the left. Corners are mitred. */
export function beside(line: FlatLine, offset: number): number[] {
  const moved: number[] = [];
  for (let i = 0; i < line.length; i += 2) {
    const before = i > 0 ? direction(line, i) : undefined;
    const after = i + 2 < line.length ? direction(line, i + 2) : undefined;
    const [ax, ay] = before ?? after ?? [1, 0];
    const [bx, by] = after ?? before ?? [1, 0];
    let nx = -(ay + by);
    let ny = ax + bx;
    const size = Math.hypot(nx, ny) || 1;
    nx /= size;
    ny /= size;
    const mitre = Math.max(-ay * nx + ax * ny, 0.5);
    moved.push(at(line, i) + (offset * nx) / mitre, at(line, i + 1) + (offset * ny) / mitre);
  }
  return moved;
}

function direction(line: FlatLine, i: number): [number, number] {
  const piece = pieceLength(line, i) || 1;
  return [(at(line, i) - at(line, i - 2)) / piece, (at(line, i + 1) - at(line, i - 1)) / piece];
}

/** Returns the dashes of a broken line, each as a flat line of two or more points. */
export function dashes(line: FlatLine, dash: number, gap: number): number[][] {
  const found: number[][] = [];
  const whole = lengthOf(line);
  for (let start = gap / 2; start < whole; start += dash + gap) {
    const from = placeAt(line, start);
    const to = placeAt(line, Math.min(start + dash, whole));
    found.push([from.x, from.y, to.x, to.y]);
  }
  return found;
}

/** The foot of a point on a line. */
export interface Foot {
  /** Metres along the line. */
  readonly along: number;
  /** Metres beside it, positive to the left. */
  readonly lateral: number;
  readonly distance: number;
}

export function footOn(line: FlatLine, x: number, y: number): Foot {
  let best: Foot = { along: 0, lateral: 0, distance: Number.POSITIVE_INFINITY };
  let before = 0;
  for (let i = 2; i < line.length; i += 2) {
    const piece = pieceLength(line, i);
    if (piece > 0) {
      const [dx, dy] = direction(line, i);
      const px = x - at(line, i - 2);
      const py = y - at(line, i - 1);
      const along = Math.min(Math.max(px * dx + py * dy, 0), piece);
      const distance = Math.hypot(px - along * dx, py - along * dy);
      if (distance < best.distance)
        best = { along: before + along, lateral: dx * py - dy * px, distance };
    }
    before += piece;
  }
  return best;
}

/** Returns whether a point is inside an outline. */
export function isInside(outline: FlatLine, x: number, y: number): boolean {
  let inside = false;
  for (let i = 0, j = outline.length - 2; i < outline.length; j = i, i += 2) {
    const ay = at(outline, i + 1);
    const by = at(outline, j + 1);
    if (ay > y === by > y) continue;
    const ax = at(outline, i);
    if (x < ax + ((at(outline, j) - ax) * (y - ay)) / (by - ay)) inside = !inside;
  }
  return inside;
}
