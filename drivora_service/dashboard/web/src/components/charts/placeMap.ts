/** A part of the plane in metres: x and y of two opposite corners. */
export type Bounds = readonly [number, number, number, number];

/** Where metres are drawn: y points up in the world, and down on the screen. */
export interface Plan {
  readonly height: number;
  readonly toX: (x: number) => number;
  readonly toY: (y: number) => number;
  /** Returns the place in the world that is drawn at pixels. */
  readonly from: (left: number, top: number) => readonly [number, number];
  /** Pixels of a metre. */
  readonly scale: number;
}

const LOWEST = 0.25;
const HIGHEST = 0.6;

/** Fits a part of the plane into a width; a long narrow part is not drawn too low, nor a high one too high. */
export function planOf([left, bottom, right, top]: Bounds, width: number, margin = 12): Plan {
  const across = Math.max(right - left, 1);
  const up = Math.max(top - bottom, 1);
  const height = Math.round(width * Math.min(Math.max(up / across, LOWEST), HIGHEST));
  const scale = Math.min((width - 2 * margin) / across, (height - 2 * margin) / up);
  const x0 = width / 2 - (scale * (left + right)) / 2;
  const y0 = height / 2 + (scale * (bottom + top)) / 2;
  return {
    height,
    toX: (x) => x0 + scale * x,
    toY: (y) => y0 - scale * y,
    from: (left, top) => [(left - x0) / scale, (y0 - top) / scale],
    scale,
  };
}

/** Returns the part of the plane that a plan shows. */
export function shownBy({ from, height }: Plan, width: number): Bounds {
  const [left, top] = from(0, 0);
  const [right, bottom] = from(width, height);
  return [left, bottom, right, top];
}

/** Returns a flat line, x and y in turn, as a path of a drawing. */
export function linePath(line: readonly number[], { toX, toY }: Plan): string {
  let path = "";
  for (let i = 0; i + 1 < line.length; i += 2) {
    const x = toX(line[i] ?? Number.NaN).toFixed(1);
    path += `${i === 0 ? "M" : "L"}${x},${toY(line[i + 1] ?? Number.NaN).toFixed(1)}`;
  }
  return path;
}

/** Returns the part of the plane around points, with room; undefined without points. */
export function boundsOf(points: readonly (readonly number[])[], room: number): Bounds | undefined {
  if (points.length === 0) return undefined;
  const xs = points.map(([x = 0]) => x);
  const ys = points.map(([, y = 0]) => y);
  return [
    Math.min(...xs) - room,
    Math.min(...ys) - room,
    Math.max(...xs) + room,
    Math.max(...ys) + room,
  ];
}

/** Whether a line may touch a part of the plane: whether its box does. */
export function touches(line: readonly (readonly number[])[], bounds: Bounds): boolean {
  const box = boundsOf(line, 0);
  if (!box) return false;
  return box[0] <= bounds[2] && box[2] >= bounds[0] && box[1] <= bounds[3] && box[3] >= bounds[1];
}
