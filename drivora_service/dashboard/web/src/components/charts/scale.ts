/** Returns where a value of a quantity is drawn. */
export type Scale = (value: number) => number;

/** Maps `[low, high]` linearly to `[from, to]` pixels; an empty range maps to its middle. */
export function linear(low: number, high: number, from: number, to: number): Scale {
  if (high === low) return () => (from + to) / 2;
  return (value) => from + ((value - low) / (high - low)) * (to - from);
}

/** Returns round numbers (1, 2 or 5 times a power of ten) between two values, about `about` of them. */
export function ticks(low: number, high: number, about = 5): readonly number[] {
  if (!(high > low)) return [low];
  const rough = (high - low) / Math.max(about, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const factor = rough / power;
  const step = power * (factor < 1.5 ? 1 : factor < 3.5 ? 2 : factor < 7.5 ? 5 : 10);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, place) => round((first + place) * step));
}

/** Returns ticks of counts: whole numbers only. */
export function wholeTicks(low: number, high: number, about = 5): readonly number[] {
  return ticks(low, high, Math.min(about, Math.max(high - low, 1))).filter(Number.isInteger);
}

/** Takes away what binary fractions add: 0.1 + 0.2. */
function round(value: number): number {
  return Number(value.toPrecision(12));
}

/** Widens a range to round ends and a little room, so that no mark lies on the frame. */
export function rounded(values: readonly number[], about = 5): readonly [number, number] {
  const known = values.filter(Number.isFinite);
  if (known.length === 0) return [0, 1];
  const low = Math.min(...known);
  const high = Math.max(...known);
  if (low === high) return [low - (Math.abs(low) || 1) / 2, high + (Math.abs(high) || 1) / 2];
  const marks = ticks(low, high, about);
  const step = (marks[1] ?? high) - (marks[0] ?? low) || high - low;
  return [round(Math.floor(low / step) * step), round(Math.ceil(high / step) * step)];
}

const compact = new Intl.NumberFormat("en", { maximumSignificantDigits: 4 });

/** Returns a tick's number. */
export function tickText(value: number): string {
  return compact.format(value).replace("-", "−");
}

/** Moves labels apart: each at least `gap` from the one before, in the order of their wishes. */
export function spread(
  wishes: readonly number[],
  gap: number,
  low: number,
  high: number,
): readonly number[] {
  const order = wishes.map((_, place) => place).sort((a, b) => at(wishes, a) - at(wishes, b));
  const placed = [...wishes];
  let free = low;
  for (const place of order) {
    placed[place] = Math.max(at(wishes, place), free);
    free = at(placed, place) + gap;
  }
  let limit = high;
  for (const place of order.toReversed()) {
    placed[place] = Math.min(at(placed, place), limit);
    limit = at(placed, place) - gap;
  }
  return placed;
}

function at(values: readonly number[], place: number): number {
  return values[place] ?? 0;
}
