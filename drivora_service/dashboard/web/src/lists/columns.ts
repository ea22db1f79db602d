import type { Column } from "../components/DataTable";
import { useRemembered } from "./remembered";

/** Returns the ids of the columns that a reader chose, as far as the list has them. */
export function chosenIds(
  stored: unknown,
  known: readonly string[],
  usual: readonly string[],
): readonly string[] {
  if (!Array.isArray(stored)) return usual;
  const found = known.filter((id) => stored.includes(id));
  return found.length > 0 ? found : usual;
}

/** The columns of a list: which are shown is remembered by this browser. */
export function useColumns<Row>(
  list: string,
  all: readonly Column<Row>[],
  usual: readonly string[],
) {
  const known = all.map(({ id }) => id);
  const [ids, set] = useRemembered(`drivora-columns-${list}`, (stored) =>
    chosenIds(stored, known, usual),
  );
  return {
    shown: all.filter(({ id }) => ids.includes(id)),
    ids,
    toggle: (id: string) =>
      set(known.filter((item) => (item === id ? !ids.includes(id) : ids.includes(item)))),
    reset: () => set(null),
  };
}
