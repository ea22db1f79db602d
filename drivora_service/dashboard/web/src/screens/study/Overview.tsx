import type { Schemas } from "../../api/client";

/** How methods or ADSs stand over all places: the answer before the figures. */
export function Overview({ rows }: { readonly rows: readonly Schemas["OverviewRow"][] }) {
  if (rows.length === 0) return null;
  return (
    <div className="plain-table">
      <table aria-label="All places together">
        <thead>
          <tr>
            <th scope="col">Name</th>
            <th scope="col">Measure</th>
            <th scope="col" className="number">
              Median
            </th>
            <th scope="col" className="number">
              Baseline's
            </th>
            <th scope="col" className="number">
              A12, mean
            </th>
            <th scope="col" className="number">
              Better
            </th>
            <th scope="col" className="number">
              Worse
            </th>
            <th scope="col" className="number">
              Undecided
            </th>
          </tr>
        </thead>
        <tbody>
          {rows.map((row) => (
            <tr key={`${row.name} ${row.measure}`}>
              <td>
                {row.name} <span className="quiet">against {row.baseline}</span>
              </td>
              <td>{row.title}</td>
              <td className="number">{Number(row.median.toPrecision(4))}</td>
              <td className="number">{Number(row.baseline_median.toPrecision(4))}</td>
              <td className="number">{row.a12.toFixed(2)}</td>
              <td className="number">
                {row.better} <span className="quiet">of {row.places}</span>
              </td>
              <td className="number">{row.worse}</td>
              <td className="number">{row.undecided}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}
