import { differing } from "./flatten";

/** A table of only those settings in which things differ. */
export function Differing({
  title,
  names,
  documents,
}: {
  readonly title: string;
  readonly names: readonly string[];
  readonly documents: readonly unknown[];
}) {
  const rows = differing(documents);
  if (names.length < 2) return null;
  return (
    <section>
      <h3>{title}</h3>
      {rows.length === 0 ? (
        <p className="quiet">They differ by name only.</p>
      ) : (
        <div className="plain-table">
          <table aria-label={title}>
            <thead>
              <tr>
                <th scope="col">Setting</th>
                {names.map((name) => (
                  <th key={name} scope="col">
                    {name}
                  </th>
                ))}
              </tr>
            </thead>
            <tbody>
              {rows.map(({ path, values }) => (
                <tr key={path}>
                  <td>
                    <code>{path}</code>
                  </td>
                  {values.map((value, place) => (
                    <td key={names[place]}>
                      {value === "" ? <span className="quiet">not set</span> : value}
                    </td>
                  ))}
                </tr>
              ))}
            </tbody>
          </table>
        </div>
      )}
    </section>
  );
}
