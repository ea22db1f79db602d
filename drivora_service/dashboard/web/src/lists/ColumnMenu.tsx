import type { Column } from "../components/DataTable";
import { Menu } from "../components/Menu";

/** Which columns a list shows. */
export function ColumnMenu<Row>({
  all,
  ids,
  toggle,
  reset,
}: {
  readonly all: readonly Column<Row>[];
  readonly ids: readonly string[];
  readonly toggle: (id: string) => void;
  readonly reset: () => void;
}) {
  return (
    <Menu label="Columns" align="right">
      {() => (
        <>
          <ul className="menu-list">
            {all.map(({ id, title, hint }) => (
              <li key={id}>
                <label className="check" title={hint}>
                  <input
                    type="checkbox"
                    checked={ids.includes(id)}
                    disabled={ids.length === 1 && ids.includes(id)}
                    onChange={() => toggle(id)}
                  />
                  {title}
                </label>
              </li>
            ))}
          </ul>
          <button type="button" onClick={reset}>
            Usual columns
          </button>
        </>
      )}
    </Menu>
  );
}
