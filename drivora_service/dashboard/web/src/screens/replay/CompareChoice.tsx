import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { api, body, type Schemas } from "../../api/client";
import { Mark } from "../../components/Mark";
import { moment } from "../../components/numbers";
import { readPages } from "../../lists/readPages";
import { lookOfRun } from "../runs/status";
import { choicesOf, MOST_OFFERED } from "./compareChoices";
import "./compare.css";

type Summary = Schemas["RunSummary"];

/** Pages of the newest runs that are looked through for recorded ones: campaigns keep few. */
const MOST_PAGES = 8;

/** Returns finished runs with a recording, the newest first: as many as are offered. */
async function recorded(of: { readonly town?: string; readonly scenario_sha256?: string }) {
  let pages = 0;
  const { rows } = await readPages<Summary>(async (pageToken) => {
    const query = { ...of, ...pageToken, status: ["finished" as const], limit: 200 };
    const page = body(await api.GET("/api/v1/runs", { params: { query } }));
    pages += 1;
    return {
      items: page.items.filter(({ trace_sha256 }) => trace_sha256 !== ""),
      next_page_token: pages < MOST_PAGES ? page.next_page_token : "",
    };
  }, MOST_OFFERED);
  return rows;
}

/** Chooses a run to compare with: those of the same scenario come first, however old they are. */
export function CompareChoice({
  run,
  put,
}: {
  readonly run: Schemas["Run"];
  readonly put: (changes: { readonly with: string }) => void;
}) {
  const [wanted, setWanted] = useState(false);
  const { scenario_sha256, town } = run;
  const { data, isPending, error } = useQuery({
    queryKey: ["run", "list", "to compare", town, scenario_sha256],
    queryFn: async () => {
      const [scenario, network] = await Promise.all([
        scenario_sha256 ? recorded({ scenario_sha256 }) : [],
        recorded({ town }),
      ]);
      return { scenario, network };
    },
    enabled: wanted,
  });
  const groups = data && choicesOf(run, data.scenario, data.network);
  const choose = (one: Summary) => put({ with: one.id });
  return (
    <details className="choice" onToggle={(event) => setWanted(event.currentTarget.open)}>
      <summary className="button">Compare…</summary>
      <div className="list">
        {isPending && wanted && <p className="quiet">Loading</p>}
        {error && <p role="alert">{error.message}</p>}
        {groups && groups.scenario.length + groups.network.length === 0 && (
          <p>No other recorded run on {town}.</p>
        )}
        {groups && <Group title="Same scenario" runs={groups.scenario} onChoose={choose} />}
        {groups && <Group title="Same network" runs={groups.network} onChoose={choose} />}
      </div>
    </details>
  );
}

function Group({
  title,
  runs,
  onChoose,
}: {
  readonly title: string;
  readonly runs: readonly Summary[];
  readonly onChoose: (run: Summary) => void;
}) {
  if (runs.length === 0) return null;
  return (
    <section aria-label={title}>
      <h3>{title}</h3>
      {runs.map((one) => (
        <button key={one.id} type="button" onClick={() => onChoose(one)} title={one.id}>
          <span>{one.label || one.id}</span>
          <Mark {...lookOfRun(one)} />
          <span className="quiet">
            {one.agent}
            {one.seed !== null && `, seed ${one.seed}`}
          </span>
          <span className="quiet">{moment(one.created_at)}</span>
        </button>
      ))}
    </section>
  );
}
