import { type Search, valuesOf } from "../address";

export interface Filter {
  /** Name of the parameter, in the address and in the API. */
  readonly name: string;
  readonly title: string;
  /** Allowed values; without them the reader types one. */
  readonly values?: readonly string[];
  /** What a value is called, where it is not its own name. */
  readonly words?: Readonly<Record<string, string>>;
  /** How many objects a list has with each value. */
  readonly counts?: Readonly<Record<string, number>> | undefined;
  /** Whether the API takes one value only: a second replaces the first. */
  readonly single?: boolean;
  /** A time instead of a value: the reader chooses how far back. */
  readonly time?: boolean;
  readonly hint?: string;
}

/** Returns the values of a filter that are set: of one that is single, as the API, the last. */
export function chosenValues(search: Search, { name, single, time }: Filter): readonly string[] {
  const values = valuesOf(search, name);
  return single || time ? values.slice(-1) : values;
}

/** Returns the words for a value of a filter. */
export function wordsFor(filter: Filter, value: string): string {
  return filter.words?.[value] ?? value.replaceAll("_", " ");
}

/** Returns the address's values with one more, or without it if it is there. */
export function withToggled(search: Search, filter: Filter, value: string): Search {
  const now = chosenValues(search, filter);
  const next = now.includes(value)
    ? now.filter((item) => item !== value)
    : filter.single
      ? [value]
      : [...now, value];
  return { ...search, [filter.name]: next };
}

/** Returns the address without any of the filters. */
export function withoutFilters(search: Search, filters: readonly Filter[]): Search {
  const names = new Set(filters.map(({ name }) => name));
  return Object.fromEntries(Object.entries(search).filter(([name]) => !names.has(name)));
}

/** Returns what a list asks the API for: the filters that are set, each as the API takes it. */
export function askedBy(
  search: Search,
  filters: readonly Filter[],
): Record<string, string | readonly string[]> {
  const asked: Record<string, string | readonly string[]> = {};
  for (const filter of filters) {
    const { name, single, time } = filter;
    const values = chosenValues(search, filter);
    if (values[0] !== undefined) asked[name] = single || time ? values[0] : values;
  }
  return asked;
}

/** Returns the values to offer: those with objects first, the most frequent first. */
export function offered(filter: Filter, chosen: readonly string[]): readonly string[] {
  const known = filter.values ?? Object.keys(filter.counts ?? {});
  const all = [...known, ...chosen.filter((value) => !known.includes(value))];
  const { counts } = filter;
  if (!counts) return all;
  return all.toSorted((a, b) => (counts[b] ?? 0) - (counts[a] ?? 0));
}
