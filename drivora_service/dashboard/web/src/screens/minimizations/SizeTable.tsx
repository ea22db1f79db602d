import { type Size, sizeRows } from "./minimization";

/** The sizes of the scenario as it was and of the smallest one, side by side. */
export function SizeTable({ before, after }: { readonly before: Size; readonly after: Size }) {
  return (
    <section className="panel">
      <header>
        <h2>Size of the scenario</h2>
      </header>
      <table className="matrix sizes" aria-label="Size of the scenario">
        <thead>
          <tr>
            <td />
            <th scope="col" className="number">
              before
            </th>
            <th scope="col" className="number">
              after
            </th>
            <td />
          </tr>
        </thead>
        <tbody>
          {sizeRows(before, after).map((row) => (
            <tr key={row.name} data-part={row.isPart} data-same={row.before === row.after}>
              <th scope="row">
                {row.name}
                {row.unit && <span className="quiet"> ({row.unit})</span>}
              </th>
              <td className="number">{row.before}</td>
              <td className="number">{row.after}</td>
              <td className="left" aria-hidden="true">
                {!row.isPart && (
                  <span className="rail">
                    <span style={{ width: `${100 * row.share}%` }} />
                  </span>
                )}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}
