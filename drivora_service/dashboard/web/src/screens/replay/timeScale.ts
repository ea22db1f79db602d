/** A part of a run's time, seconds. */
export interface Range {
  readonly from: number;
  readonly to: number;
}

const LEAST_S = 0.5;

/** Returns a range nearer by a factor, with one time at its place, within the run. */
export function zoomRange(range: Range, at: number, factor: number, end: number): Range {
  const length = Math.min(
    Math.max((range.to - range.from) / factor, LEAST_S),
    Math.max(end, LEAST_S),
  );
  const share = (at - range.from) / (range.to - range.from);
  return shifted({ from: at - share * length, to: at + (1 - share) * length }, 0, end);
}

/** Returns a range moved by seconds, within the run. */
export function shifted(range: Range, by: number, end: number): Range {
  const length = Math.min(range.to - range.from, Math.max(end, LEAST_S));
  const from = Math.min(Math.max(range.from + by, 0), Math.max(end - length, 0));
  return { from, to: from + length };
}

/** Share of a range that lies beyond a time that has left it. */
const AHEAD = 0.85;

/** Returns a range, moved on if a time is outside it, so that what comes next can be seen too. */
export function holding(range: Range, time: number, end: number): Range {
  const { from, to } = range;
  if (time >= from - 1e-6 && time <= to + 1e-6) return range;
  const length = to - from;
  const begin = time > to ? time - (1 - AHEAD) * length : time - AHEAD * length;
  return shifted(range, begin - from, end);
}

/** Whether a range is a part of the run only. */
export function isPart({ from, to }: Range, end: number): boolean {
  return from > 0.005 || to < end - 0.005;
}

/** Returns a range of an address within the run; the whole run if there is none. */
export function withinRun(range: Range | undefined, end: number): Range {
  if (!range || range.from >= end) return { from: 0, to: end };
  const { from } = range;
  const length = Math.max(Math.min(range.to, end) - from, LEAST_S);
  return shifted({ from, to: from + length }, 0, end);
}

/** Returns round times of a range, about as many as wanted. */
export function ticks(range: Range, count: number): readonly number[] {
  const apart = (range.to - range.from) / count;
  const power = 10 ** Math.floor(Math.log10(apart));
  const step = [1, 2, 5, 10].find((one) => one * power >= apart) ?? 10;
  const size = step * power;
  const found: number[] = [];
  for (let k = Math.ceil(range.from / size - 1e-9); k * size <= range.to + 1e-9; k++)
    found.push(Number((k * size).toFixed(6)));
  return found;
}

/**
 * Returns round values between two bounds for the labels of an axis: at least two of them, and
 * about as many as `most` at most.
 */
export function valueTicks(low: number, high: number, most: number): readonly number[] {
  let finer: readonly number[] = [];
  const power = Math.floor(Math.log10((high - low) / Math.max(most, 2))) - 1;
  for (let place = 0; place < 12; place++) {
    const size = ([1, 2, 5][place % 3] ?? 1) * 10 ** (power + Math.floor(place / 3));
    const first = Math.ceil(low / size - 1e-9);
    const last = Math.floor(high / size + 1e-9);
    const count = Math.max(last - first + 1, 0);
    if (count > 40) continue;
    // One value says nothing of the scale.
    if (count < 2) return finer;
    finer = Array.from({ length: count }, (_, k) => Number(((first + k) * size).toPrecision(12)));
    if (count <= most) return finer;
  }
  return finer;
}

/**
 * Returns times for marks that would cover each other: of one row, each at least `apart` on. Of
 * those of one moment the one of the greatest weight stays there.
 */
export function seatsOf(
  marks: readonly { readonly row: string; readonly time: number; readonly weight?: number }[],
  apart: number,
): readonly number[] {
  const free = new Map<string, number>();
  const seats = marks.map(({ time }) => time);
  const weight = (place: number) => marks[place]?.weight ?? 0;
  const order = marks
    .map((_, place) => place)
    .sort(
      (a, b) => (marks[b]?.time ?? 0) - (marks[a]?.time ?? 0) || weight(b) - weight(a) || b - a,
    );
  // From the end back, so that no mark is moved beyond the end of the run.
  for (const place of order) {
    const mark = marks[place];
    if (!mark || mark.time < 0) continue;
    const at = Math.min(mark.time, free.get(mark.row) ?? Number.POSITIVE_INFINITY);
    seats[place] = at;
    free.set(mark.row, at - apart);
  }
  return seats;
}
