import { Link } from "@tanstack/react-router";
import type { Search } from "../../address";
import { count } from "../../components/numbers";

/** How many runs have each value of a part, as bars that lead to them. */
export function BatchParts({
  title,
  numbers,
  searchFor,
  words = (value) => value,
}: {
  readonly title: string;
  readonly numbers: Readonly<Record<string, number>>;
  readonly searchFor: (value: string) => Search;
  readonly words?: (value: string) => string;
}) {
  const parts = Object.entries(numbers).toSorted(([, a], [, b]) => b - a);
  const most = parts[0]?.[1] ?? 0;
  if (parts.length === 0) return null;
  return (
    <section className="panel">
      <header>
        <h2>{title}</h2>
      </header>
      <ul className="bars inside">
        {parts.map(([value, number]) => (
          <li key={value}>
            <Link to="/runs" search={searchFor(value)}>
              {words(value)}
            </Link>
            <span className="bar" aria-hidden="true">
              <span style={{ width: `${(number / most) * 100}%` }} />
            </span>
            <span className="number">{count(number)}</span>
          </li>
        ))}
      </ul>
    </section>
  );
}
