import { Link } from "@tanstack/react-router";
import type { ReactNode } from "react";
import type { Schemas } from "../../api/client";
import { Mark } from "../../components/Mark";
import { count, duration } from "../../components/numbers";
import { lookOfSearch, shortName } from "../campaigns/state";
import { kindText } from "../failures/words";

type Campaign = Schemas["Campaign"];

interface Fact {
  readonly title: string;
  /** What tells whether campaigns differ. */
  readonly of: (campaign: Campaign) => string;
  readonly show?: (campaign: Campaign) => ReactNode;
  readonly numeric?: boolean;
}

const FACTS: readonly Fact[] = [
  {
    title: "State",
    of: ({ state }) => state,
    show: ({ state, request }) => <Mark {...lookOfSearch(state, request)} />,
  },
  { title: "Method", of: ({ cell, tester }) => cell?.method ?? tester },
  { title: "ADS", of: ({ cell, configuration }) => cell?.agent ?? configuration },
  { title: "Scene", of: ({ cell, town }) => cell?.scenario ?? town },
  {
    title: "Simulations",
    numeric: true,
    of: ({ simulations, budget }) => `${count(simulations)} of ${count(budget)}`,
  },
  {
    title: "With an avoidable failure",
    numeric: true,
    of: ({ counts }) => (counts.avoidable === null ? "unknown" : count(counts.avoidable)),
    show: ({ id, counts }) =>
      counts.avoidable ? (
        <Link
          className="bad"
          to="/campaigns/$id"
          params={{ id }}
          search={{ tab: "failures", accountability: "avoidable" }}
        >
          {count(counts.avoidable)}
        </Link>
      ) : counts.avoidable === null ? (
        "unknown"
      ) : (
        "0"
      ),
  },
  {
    title: "With any failure",
    numeric: true,
    of: ({ counts }) => count(counts.violating),
    show: ({ id, counts }) => (
      <Link to="/campaigns/$id" params={{ id }} search={{ tab: "evaluations", violating: "true" }}>
        {count(counts.violating)}
      </Link>
    ),
  },
  {
    title: "Without a result",
    numeric: true,
    of: ({ counts }) => count(counts.failed + counts.invalid),
  },
  { title: "Kinds of failures", numeric: true, of: ({ kinds }) => count(kinds.length) },
  {
    title: "Most frequent kind",
    of: ({ kinds }) => {
      const most = [...kinds].sort((a, b) => b.failures - a.failures)[0];
      return most ? kindText(most.kind) : "none";
    },
  },
  { title: "Work", numeric: true, of: ({ active_s }) => duration(active_s) },
];

/** A column each: what differs first, then what is the same in all. */
export function SideBySide({ campaigns }: { readonly campaigns: readonly Campaign[] }) {
  const differs = ({ of }: Fact) => new Set(campaigns.map(of)).size > 1;
  const rows = [...FACTS.filter(differs), ...FACTS.filter((fact) => !differs(fact))];
  return (
    <div className="plain-table side-by-side">
      <table aria-label="Campaigns side by side">
        <thead>
          <tr>
            <th scope="col">
              <span className="hidden-visually">Fact</span>
            </th>
            {campaigns.map(({ id, name, cell }, place) => (
              <th key={id} scope="col">
                {place + 1}{" "}
                <Link to="/campaigns/$id" params={{ id }} search={{}}>
                  {shortName(name, cell) || id}
                </Link>
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {rows.map((fact) => (
            <tr key={fact.title} className={differs(fact) ? undefined : "quiet"}>
              <th scope="row">{fact.title}</th>
              {campaigns.map((campaign) => (
                <td key={campaign.id}>{(fact.show ?? fact.of)(campaign)}</td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}
