import { Link } from "@tanstack/react-router";
import type { Search } from "../../address";
import type { Schemas } from "../../api/client";
import { count } from "../../components/numbers";
import { pointsText, probability, type WhichFails } from "./paired";

/** In how many scenarios A and B fail, as a table of two by two; each number leads to its pairs. */
export function Table({
  failures,
  test,
  search,
}: {
  readonly failures: Schemas["FailureComparison"];
  /** The name of the test. */
  readonly test: string;
  readonly search: Search;
}) {
  const cell = (fails: WhichFails, words: string) => (
    <td data-fails={fails} data-any={failures[fails] > 0}>
      <Link
        to="."
        search={{ ...search, show: fails, oracle: undefined }}
        replace
        resetScroll={false}
      >
        <strong>{count(failures[fails])}</strong>
      </Link>
      <span>{words}</span>
    </td>
  );
  return (
    <section className="panel">
      <header>
        <h2>Scenarios</h2>
        <span className="quiet">
          p {probability(failures.p)}, {test}
        </span>
      </header>
      <div className="inside stack">
        <table className="two-by-two" aria-label="Scenarios by which of A and B fails">
          <thead>
            <tr>
              <td />
              <th scope="col">B fails</th>
              <th scope="col">B does not fail</th>
            </tr>
          </thead>
          <tbody>
            <tr>
              <th scope="row">A fails</th>
              {cell("both", "both fail")}
              {cell("a_only", "better in B")}
            </tr>
            <tr>
              <th scope="row">A does not fail</th>
              {cell("b_only", "worse in B")}
              {cell("neither", "neither fails")}
            </tr>
          </tbody>
        </table>
        <p className="quiet">
          Share of scenarios with a failure, B − A: {pointsText(failures)} percentage points.
        </p>
      </div>
    </section>
  );
}
