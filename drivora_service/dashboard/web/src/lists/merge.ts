/** How a list that is shown takes what has changed, without rows that move under the pointer. */

/** What has changed since the pages of a list were read. */
export interface Overlay<Row> {
  /** New rows that were inserted before all pages. */
  readonly inserted: readonly Row[];
  /** New rows that wait to be inserted. */
  readonly news: readonly Row[];
  /** Newer states of rows, by id. */
  readonly fresh: ReadonlyMap<string, Row>;
  /** Rows that the list would not have any more, but that keep their places. */
  readonly left: ReadonlySet<string>;
  /** Rows that are not shown any more. */
  readonly gone: ReadonlySet<string>;
}

export const UNCHANGED: Overlay<never> = {
  inserted: [],
  news: [],
  fresh: new Map<string, never>(),
  left: new Set(),
  gone: new Set(),
};

/** Returns the rows of a list: those of its pages under what has changed since. */
export function rowsOf<Row>(
  read: readonly Row[],
  { inserted, fresh, gone }: Overlay<Row>,
  idOf: (row: Row) => string,
): readonly Row[] {
  if (inserted.length === 0 && fresh.size === 0 && gone.size === 0) return read;
  return [...inserted, ...read]
    .filter((row) => !gone.has(idOf(row)))
    .map((row) => fresh.get(idOf(row)) ?? row);
}

/** Returns the rows of a fresh first page that come before all known ones. */
export function newRows<Row>(
  known: readonly Row[],
  fresh: readonly Row[],
  idOf: (row: Row) => string,
): readonly Row[] {
  const ids = new Set(known.map(idOf));
  const firstKnown = fresh.findIndex((row) => ids.has(idOf(row)));
  return firstKnown < 0 ? fresh : fresh.slice(0, firstKnown);
}

/** Returns how many rows of a page its fresh answer covers: those that are not in it have left.
 *
 * New rows before a page push others out of the answer: those have not left.
 */
export function coverage<Row>(
  page: readonly Row[],
  fresh: readonly Row[],
  more: boolean,
  idOf: (row: Row) => string,
): number {
  if (!more) return page.length;
  const places = new Map(page.map((row, place) => [idOf(row), place]));
  let last = -1;
  for (const row of fresh) last = places.get(idOf(row)) ?? (last < 0 ? -1 : page.length - 1);
  return last + 1;
}

/** Takes fresh rows where they are.
 *
 * @param covered Ids of changed rows whose place was asked for again: those that `fresh` does not
 *   have have left the list.
 */
export function renewed<Row>(
  now: Overlay<Row>,
  rows: readonly Row[],
  covered: ReadonlySet<string>,
  idOf: (row: Row) => string,
): Overlay<Row> {
  const fresh = new Map(now.fresh);
  const left = new Set(now.left);
  const gone = new Set(now.gone);
  for (const row of rows) {
    fresh.set(idOf(row), row);
    left.delete(idOf(row));
    gone.delete(idOf(row));
  }
  const had = new Set(rows.map(idOf));
  for (const id of covered) if (!had.has(id)) left.add(id);
  return { ...now, fresh, left, gone };
}

/** Takes away the rows that have left. */
export function settled<Row>(now: Overlay<Row>): Overlay<Row> {
  if (now.left.size === 0) return now;
  return { ...now, gone: new Set([...now.gone, ...now.left]), left: new Set() };
}

/** Inserts the new rows that waited. */
export function inserted<Row>(now: Overlay<Row>): Overlay<Row> {
  return { ...now, inserted: [...now.news, ...now.inserted], news: [] };
}
