import { Link } from "@tanstack/react-router";
import type { Search } from "../../address";
import type { Schemas } from "../../api/client";
import { count } from "../../components/numbers";
import { OracleHelp } from "../../help/OracleHelp";
import { pointsText, probability, type Shown } from "./paired";

type Failure = Schemas["FailureComparison"];

const COUNTS = [
  { name: "a_only", title: "Only A" },
  { name: "b_only", title: "Only B" },
  { name: "both", title: "Both" },
] as const;

/** The failures of A and B by oracle; each number leads to its pairs. */
export function Oracles({
  rows,
  search,
  scenarios,
  test,
}: {
  readonly rows: readonly Failure[];
  readonly search: Search;
  readonly scenarios: number;
  /** The name of the test. */
  readonly test: string;
}) {
  return (
    <section className="panel">
      <header>
        <h2>Failures by oracle</h2>
        <span className="quiet">
          of {count(scenarios)} scenarios; p: {test}, corrected by Holm
        </span>
      </header>
      <table className="matrix" aria-label="Failures by oracle">
        <thead>
          <tr>
            <th scope="col">Oracle</th>
            {COUNTS.map(({ name, title }) => (
              <th key={name} scope="col" className="number">
                {title}
              </th>
            ))}
            <th scope="col" className="number" title="Pairs in which a run could not be judged">
              Not measurable
            </th>
            <th
              scope="col"
              className="number"
              title="Pairs with a run in which this oracle does not count as defined"
            >
              Not counted
            </th>
            <th scope="col" className="number">
              B − A, points [95 %]
            </th>
            <th scope="col" className="number">
              p
            </th>
            <th scope="col">B is</th>
          </tr>
        </thead>
        <tbody>
          {rows.map((row) => (
            <tr key={row.oracle}>
              <th scope="row">
                <OracleHelp name={row.oracle} />
              </th>
              {COUNTS.map(({ name }) => (
                <Count key={name} row={row} show={name} search={search} />
              ))}
              <td className="number">
                {row.not_measurable > 0 ? (
                  count(row.not_measurable)
                ) : (
                  <span className="quiet">0</span>
                )}
              </td>
              <td className="number">
                {row.not_counted > 0 ? count(row.not_counted) : <span className="quiet">0</span>}
              </td>
              <td className="number">{pointsText(row)}</td>
              <td className="number">{probability(row.p_holm)}</td>
              <td>{row.judgement}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}

function Count({
  row,
  show,
  search,
}: {
  readonly row: Failure;
  readonly show: Shown & ("a_only" | "b_only" | "both");
  readonly search: Search;
}) {
  const number = row[show];
  return (
    <td className="number" data-bad={show === "b_only" && number > 0}>
      {number > 0 ? (
        <Link to="." search={{ ...search, show, oracle: row.oracle }} replace resetScroll={false}>
          {count(number)}
        </Link>
      ) : (
        <span className="quiet">0</span>
      )}
    </td>
  );
}
