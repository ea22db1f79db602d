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

/** Returns times for marks that would cover each other: of one row, each at least `apart` on. */
export function seatsOf(
  marks: readonly { readonly row: string; readonly time: number }[],
  apart: number,
): readonly number[] {
  const free = new Map<string, number>();
  const seats = marks.map(({ time }) => time);
  const order = marks.map((_, place) => place).sort((a, b) => seat(marks, b) - seat(marks, a));
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

function seat(marks: readonly { readonly time: number }[], place: number): number {
  return (marks[place]?.time ?? 0) + 1e-9 * place;
}
