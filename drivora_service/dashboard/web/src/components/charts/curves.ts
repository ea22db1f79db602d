/** Points of a curve, x ascending. */
export interface Points {
  readonly x: readonly number[];
  readonly y: readonly number[];
}

/** Returns the value of a step curve at x: that of the last point not after it. */
export function valueAt({ x, y }: Points, where: number): number | undefined {
  let low = 0;
  let high = x.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((x[middle] ?? 0) <= where) low = middle + 1;
    else high = middle;
  }
  return low === 0 ? undefined : y[low - 1];
}

/** Returns the path of a step curve, which keeps each value until the next point. */
export function stepPath(
  points: Points,
  toX: (value: number) => number,
  toY: (value: number) => number,
): string {
  return points.x
    .map((x, place) => {
      const left = toX(x).toFixed(1);
      const top = toY(points.y[place] ?? 0).toFixed(1);
      return place === 0 ? `M${left},${top}` : `H${left}V${top}`;
    })
    .join("");
}

/** Returns the outline between two step curves with the same x. */
export function bandPath(
  x: readonly number[],
  low: readonly number[],
  high: readonly number[],
  toX: (value: number) => number,
  toY: (value: number) => number,
): string {
  const upper = stepPath({ x, y: high }, toX, toY);
  // Backwards a step changes its height first and its place then.
  const lower = x
    .map((_, place) => x.length - 1 - place)
    .map((place, order) => {
      const top = toY(low[place] ?? 0).toFixed(1);
      const left = toX(x[place] ?? 0).toFixed(1);
      return order === 0 ? `V${top}` : `H${toX(x[place + 1] ?? 0).toFixed(1)}V${top}H${left}`;
    })
    .join("");
  return x.length === 0 ? "" : `${upper}${lower}Z`;
}

/** A repetition: simulations up to the event; null if it did not happen within `until`. */
export interface Waiting {
  readonly event: number | null;
  readonly until: number;
}

/**
 * Estimates the share of repetitions without the event by simulations (Kaplan and Meier, 1958).
 * Repetitions that ended without it count as long as they ran.
 */
export function survival(repetitions: readonly Waiting[]): Points {
  const events = repetitions.flatMap(({ event }) => (event === null ? [] : [event]));
  const x = [0];
  const y = [1];
  let share = 1;
  for (const time of [...new Set(events)].sort((a, b) => a - b)) {
    const waiting = repetitions.filter(({ event, until }) => (event ?? until) >= time).length;
    const happened = events.filter((event) => event === time).length;
    share *= 1 - happened / waiting;
    x.push(time);
    y.push(share);
  }
  const end = Math.max(0, ...repetitions.map(({ until }) => until));
  if (end > (x.at(-1) ?? 0)) {
    x.push(end);
    y.push(share);
  }
  return { x, y };
}

/** Returns the smallest value so far for each value; missing values change nothing. */
export function bestSoFar(values: readonly (number | null)[]): readonly (number | null)[] {
  let best: number | null = null;
  return values.map((value) => {
    if (value !== null && (best === null || value < best)) best = value;
    return best;
  });
}

/** Returns the places of the points that no other point is at least as small as in both values. */
export function paretoFront(points: readonly (readonly [number, number])[]): readonly number[] {
  const order = points
    .map((_, place) => place)
    .sort((a, b) => {
      const [ax, ay] = points[a] ?? [0, 0];
      const [bx, by] = points[b] ?? [0, 0];
      return ax - bx || ay - by;
    });
  let lowest = Number.POSITIVE_INFINITY;
  return order.filter((place) => {
    const y = points[place]?.[1] ?? Number.POSITIVE_INFINITY;
    if (y >= lowest) return false;
    lowest = y;
    return true;
  });
}

/** Five numbers of a box plot: quartiles by linear interpolation, whiskers within 1.5 box lengths. */
export interface Box {
  readonly low: number;
  readonly q1: number;
  readonly median: number;
  readonly q3: number;
  readonly high: number;
}

export function boxOf(values: readonly number[]): Box | undefined {
  const sorted = [...values].sort((a, b) => a - b);
  if (sorted.length === 0) return undefined;
  const quantile = (share: number) => {
    const place = share * (sorted.length - 1);
    const below = sorted[Math.floor(place)] ?? 0;
    const above = sorted[Math.ceil(place)] ?? below;
    return below + (above - below) * (place - Math.floor(place));
  };
  const q1 = quantile(0.25);
  const q3 = quantile(0.75);
  const reach = 1.5 * (q3 - q1);
  const within = sorted.filter((value) => value >= q1 - reach && value <= q3 + reach);
  return { low: within[0] ?? q1, q1, median: quantile(0.5), q3, high: within.at(-1) ?? q3 };
}
