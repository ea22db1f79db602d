import { Menu } from "../components/Menu";
import { fileNameOf } from "../documents/files";
import { type Conditions, RESULT_TABLES, tableAddress } from "./resultTables";

/** What the results of runs hold, each table as a file for a spreadsheet. */
export function ResultTables({
  name,
  conditions,
}: {
  /** What the files are called after. */
  readonly name: string;
  /** Which runs, as the API takes it. */
  readonly conditions: Conditions;
}) {
  return (
    <Menu
      label="Tables"
      align="right"
      title="Runs, verdicts, metrics and ADSs as CSV, for a spreadsheet"
    >
      {(close) => (
        <ul className="menu-list">
          {RESULT_TABLES.map(({ table, words }) => (
            <li key={table}>
              <a
                className="item"
                href={tableAddress(table, conditions)}
                download={`${fileNameOf(name)}-${table}.csv`}
                onClick={close}
              >
                <span className="word">{table}.csv</span> <span className="quiet">{words}</span>
              </a>
            </li>
          ))}
        </ul>
      )}
    </Menu>
  );
}
