import { count as whole } from "../numbers";

/** Counts that have the same colour. */
export interface CountClass {
  readonly from: number;
  readonly to: number;
  /** Place in the scale of colours, from 0. */
  readonly shade: number;
}

/** Colours of the scale: more are hard to tell apart. */
export const SHADES = 6;

/**
 * Returns the classes of positive counts, the least first.
 *
 * A few different counts have a class each. More are cut at equal factors: how often the pieces of
 * roads are used spans from 1 to hundreds, as all simulations begin on the same road and few reach
 * the others. Quantiles would part 100 from 101, and mean something else after each refresh.
 */
export function classesOf(counts: Iterable<number>): readonly CountClass[] {
  const known = [...new Set(counts)].filter((count) => count > 0).sort((a, b) => a - b);
  const least = known[0];
  const most = known.at(-1);
  if (least === undefined || most === undefined) return [];
  if (known.length <= SHADES)
    return known.map((count, place) => ({
      from: count,
      to: count,
      shade: shadeOf(place, known.length),
    }));
  const begins = beginsOf(least, most);
  return begins.map((from, place) => ({
    from,
    to: (begins[place + 1] ?? most + 1) - 1,
    shade: shadeOf(place, begins.length),
  }));
}

/** Returns the class of a count; undefined for 0. */
export function classOf(classes: readonly CountClass[], count: number): CountClass | undefined {
  return count > 0 ? classes.findLast(({ from }) => from <= count) : undefined;
}

/** Returns a class in words: `24`, `1,000–1,551`. */
export function classText({ from, to }: CountClass): string {
  return from === to ? whole(from) : `${whole(from)}–${whole(to)}`;
}

/** Fewer classes than colours are spread over the scale, without its faintest colour. */
function shadeOf(place: number, classes: number): number {
  if (classes >= SHADES) return place;
  return classes === 1 ? 3 : 1 + Math.round((place * (SHADES - 2)) / (classes - 1));
}

function beginsOf(least: number, most: number): readonly number[] {
  const found = [least];
  for (let step = 1; step < SHADES; step++) {
    const begin = round(least * (most / least) ** (step / SHADES));
    if (begin > (found.at(-1) ?? 0) && begin <= most) found.push(begin);
  }
  return found;
}

const ROUND = [1, 1.5, 2, 3, 5, 7, 10];

/** Returns the nearest round whole number, by its factor. */
function round(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  const distance = (number: number) => Math.abs(Math.log(number / value));
  return ROUND.map((factor) => Math.round(factor * power)).reduce((a, b) =>
    distance(b) < distance(a) ? b : a,
  );
}
