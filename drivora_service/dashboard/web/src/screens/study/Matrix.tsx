import { Link } from "@tanstack/react-router";
import type { Search } from "../../address";
import { axesOf, type Cell, keyOf } from "./cells";

/** Scenarios against ADSs and methods: failures that count, and all, of all repetitions. */
export function Matrix({
  cells,
  chosen,
  search,
}: {
  readonly cells: ReadonlyMap<string, Cell>;
  readonly chosen: string;
  readonly search: Search;
}) {
  const { scenarios, agents, methods } = axesOf(cells);
  const share = ({ failing, simulations }: Cell) => (simulations > 0 ? failing / simulations : 0);
  const most = Math.max(...[...cells.values()].map(share), 1e-9);
  return (
    <div className="plain-table study-matrix">
      <table aria-label="Failures by scenario, ADS and method">
        <thead>
          <tr>
            <th rowSpan={2} scope="col">
              Scenario
            </th>
            {agents.map((agent) => (
              <th key={agent} scope="colgroup" colSpan={methods.length}>
                {agent}
              </th>
            ))}
          </tr>
          <tr>
            {agents.flatMap((agent) =>
              methods.map((method) => (
                <th key={`${agent} ${method}`} scope="col">
                  {method}
                </th>
              )),
            )}
          </tr>
        </thead>
        <tbody>
          {scenarios.map((scenario) => (
            <tr key={scenario}>
              <th scope="row">{scenario}</th>
              {agents.flatMap((agent) =>
                methods.map((method) => {
                  const key = keyOf(scenario, agent, method);
                  const cell = cells.get(key);
                  if (!cell) return <td key={key} />;
                  const others = cell.failing - (cell.avoidable ?? 0);
                  const width = (count: number) =>
                    `${cell.simulations > 0 ? ((count / cell.simulations) * 100) / most : 0}%`;
                  return (
                    <td key={key} data-current={key === chosen}>
                      <Link
                        to="."
                        search={{ ...search, cell: key === chosen ? "" : key }}
                        resetScroll={false}
                        title={`${cell.avoidable ?? "unknown"} that count and ${others} others in ${cell.simulations} simulations of ${cell.campaigns.length} campaigns`}
                      >
                        <strong className={cell.avoidable ? "bad" : "quiet"}>
                          {cell.avoidable ?? "unknown"}
                        </strong>{" "}
                        <span className="quiet">+ {others}</span>
                        <span className="bar" aria-hidden="true">
                          <span
                            className="counting"
                            style={{ width: width(cell.avoidable ?? 0) }}
                          />
                          <span className="rest" style={{ width: width(others) }} />
                        </span>
                      </Link>
                    </td>
                  );
                }),
              )}
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}
