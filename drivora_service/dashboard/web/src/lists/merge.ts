/** How a list that is shown takes what has changed, without rows that move under the pointer. */

export interface Rows<Row> {
  readonly rows: readonly Row[];
  /** Rows that are shown, but that the list would not have any more. */
  readonly left: ReadonlySet<string>;
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

/** Replaces rows by their fresh states where they are, and marks those that changed and left.
 *
 * @param changed Ids that were told to have changed; those that `fresh` does not have any more have
 *   left the list, if their place is within what `fresh` covers.
 */
export function renewed<Row>(
  shown: Rows<Row>,
  fresh: readonly Row[],
  changed: ReadonlySet<string>,
  idOf: (row: Row) => string,
): Rows<Row> {
  const byId = new Map(fresh.map((row) => [idOf(row), row]));
  const left = new Set(shown.left);
  const rows = shown.rows.map((row) => {
    const id = idOf(row);
    const now = byId.get(id);
    if (now === undefined) {
      if (changed.has(id)) left.add(id);
      return row;
    }
    left.delete(id);
    return now;
  });
  return { rows, left };
}

/** Returns the rows without those that have left. */
export function settled<Row>(shown: Rows<Row>, idOf: (row: Row) => string): Rows<Row> {
  if (shown.left.size === 0) return shown;
  return { rows: shown.rows.filter((row) => !shown.left.has(idOf(row))), left: new Set() };
}
