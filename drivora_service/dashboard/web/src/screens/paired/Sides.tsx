import { Link } from "@tanstack/react-router";
import type { ReactNode } from "react";
import type { Schemas } from "../../api/client";
import { count, moment } from "../../components/numbers";
import type { Comparison } from "./paired";

type Batch = Schemas["ComparedBatch"];

interface Fact {
  readonly title: string;
  readonly of: (batch: Batch) => ReactNode;
}

const FACTS: readonly Fact[] = [
  {
    title: "Batch",
    of: ({ batch, name }) => (
      <Link to="/batches/$batchId" params={{ batchId: batch }} search={{}}>
        {name || <code>{batch}</code>}
      </Link>
    ),
  },
  { title: "ADS", of: ({ agents }) => agents.join(", ") },
  { title: "Queued at", of: ({ created_at }) => moment(created_at) },
  {
    title: "Runs judged",
    of: ({ batch, finished, runs }) => (
      <Link to="/runs" search={{ batch }}>
        {count(finished)} of {count(runs)}
      </Link>
    ),
  },
  { title: "Compared runs that fail", of: ({ failing }) => count(failing) },
  { title: "Not at fault, but avoidable", of: ({ preventable }) => count(preventable) },
];

/** What A and B are, and in what they differ. */
export function Sides({ found }: { readonly found: Comparison }) {
  const { a, b, differences } = found;
  return (
    <div className="plain-table side-by-side">
      <table aria-label="A and B">
        <thead>
          <tr>
            <th scope="col">
              <span className="hidden-visually">Fact</span>
            </th>
            <th scope="col">A</th>
            <th scope="col">B</th>
          </tr>
        </thead>
        <tbody>
          {FACTS.map(({ title, of }) => (
            <tr key={title}>
              <th scope="row">{title}</th>
              <td>{of(a)}</td>
              <td>{of(b)}</td>
            </tr>
          ))}
          {differences
            .filter(({ name }) => name !== "agent")
            .map((one) => (
              <tr key={one.name}>
                <th scope="row">{one.name}</th>
                <td>{one.a || "none"}</td>
                <td>{one.b || "none"}</td>
              </tr>
            ))}
        </tbody>
      </table>
    </div>
  );
}
