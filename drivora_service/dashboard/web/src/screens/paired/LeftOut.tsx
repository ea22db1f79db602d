import { Link } from "@tanstack/react-router";
import type { Schemas } from "../../api/client";
import { count } from "../../components/numbers";

const SHOWN = 500;

/** The runs that are not compared, and why. */
export function LeftOut({ rows }: { readonly rows: readonly Schemas["LeftOut"][] }) {
  if (rows.length === 0) return null;
  return (
    <details className="panel left-out">
      <summary>{count(rows.length)} left out of the comparison</summary>
      <table className="matrix" aria-label="Left out">
        <thead>
          <tr>
            <th scope="col">Scenario</th>
            <th scope="col" className="number">
              Seed
            </th>
            <th scope="col">Why</th>
            <th scope="col">Runs</th>
          </tr>
        </thead>
        <tbody>
          {rows.slice(0, SHOWN).map((row) => (
            <tr key={`${row.a} ${row.b}`}>
              <td>{row.scenario}</td>
              <td className="number">{row.seed}</td>
              <td>{row.message}</td>
              <td>
                <RunLink id={row.a} name="A" /> <RunLink id={row.b} name="B" />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
      {rows.length > SHOWN && <p className="quiet note">And {count(rows.length - SHOWN)} more.</p>}
    </details>
  );
}

function RunLink({ id, name }: { readonly id: string; readonly name: string }) {
  if (id === "") return null;
  return (
    <Link to="/runs/$runId" params={{ runId: id }} search={{}}>
      {name}
    </Link>
  );
}
