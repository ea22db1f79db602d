import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { api, body, type Schemas } from "../../api/client";
import { Mark } from "../../components/Mark";
import { moment } from "../../components/numbers";
import { lookOfRun } from "../runs/status";
import { choicesOf } from "./compareChoices";
import "./compare.css";

type Summary = Schemas["RunSummary"];

/** Newest runs of the network that are looked through. */
const LIMIT = 200;

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
      const query = { status: ["finished" as const], limit: LIMIT };
      const [scenario, network] = await Promise.all([
        scenario_sha256
          ? api.GET("/api/v1/runs", { params: { query: { ...query, scenario_sha256 } } }).then(body)
          : undefined,
        api.GET("/api/v1/runs", { params: { query: { ...query, town } } }).then(body),
      ]);
      return { scenario: scenario?.items ?? [], network: network.items };
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
