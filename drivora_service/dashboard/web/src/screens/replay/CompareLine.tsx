import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { useState } from "react";
import { api, body, type Schemas } from "../../api/client";
import { Mark } from "../../components/Mark";
import { moment } from "../../components/numbers";
import { lookOfRun } from "../runs/status";
import { type Pace, type Parting, partingWords } from "./difference";
import "./compare.css";

type Put = (changes: Record<string, string | undefined>) => void;

/** Which run is compared with, when the two part, and how they are shown. */
export function CompareLine({
  other,
  parting,
  ready,
  failure,
  view,
  pace,
  put,
  onMoment,
}: {
  readonly other: Schemas["Run"] | undefined;
  readonly parting: Parting | undefined;
  readonly ready: boolean;
  readonly failure: unknown;
  readonly view: "over" | "side";
  readonly pace: Pace;
  readonly put: Put;
  readonly onMoment: (time: number) => void;
}) {
  return (
    <div className="compare-line whole-width">
      <span>
        Compared with{" "}
        {other && (
          <Link to="/runs/$runId" params={{ runId: other.id }} search={{}}>
            {other.label || other.id}
          </Link>
        )}{" "}
        {other && <span className="quiet">{other.agent}</span>}
      </span>
      {other && <Mark {...lookOfRun(other)} />}
      {failure ? (
        <span className="quiet">
          cannot be compared: {failure instanceof Error ? failure.message : String(failure)}
        </span>
      ) : !ready ? (
        <span className="quiet">loading</span>
      ) : parting ? (
        <button type="button" onClick={() => onMoment(parting.time)}>
          {partingWords(parting)}
        </button>
      ) : (
        <span>All actors of both runs are at the same places at every step.</span>
      )}
      <span className="choices">
        <label>
          Shown{" "}
          <select
            value={view}
            onChange={(event) => put({ view: event.target.value === "side" ? "side" : undefined })}
          >
            <option value="over">over each other</option>
            <option value="side">side by side</option>
          </select>
        </label>
        <label>
          In step by{" "}
          <select
            value={pace}
            onChange={(event) =>
              put({ pace: event.target.value === "route" ? "route" : undefined })
            }
          >
            <option value="time">time</option>
            <option value="route">distance along the route</option>
          </select>
        </label>
        <button
          type="button"
          onClick={() => put({ with: undefined, view: undefined, pace: undefined })}
        >
          End the comparison
        </button>
      </span>
    </div>
  );
}

const MOST = 30;

/** Chooses a run of the same network to compare with; those of the same name come first. */
export function CompareChoice({ run, put }: { readonly run: Schemas["Run"]; readonly put: Put }) {
  const [wanted, setWanted] = useState(false);
  const { data, isPending } = useQuery({
    queryKey: ["run", "list", "to compare", run.town],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/runs", {
          params: { query: { town: run.town, status: ["finished"], limit: 200 } },
        }),
      ),
    enabled: wanted,
  });
  const found = (data?.items ?? [])
    .filter((one) => one.id !== run.id && one.trace_sha256)
    .sort((a, b) => nearness(run, b) - nearness(run, a))
    .slice(0, MOST);
  return (
    <details className="choice" onToggle={(event) => setWanted(event.currentTarget.open)}>
      <summary className="button">Compare…</summary>
      <div className="list">
        {isPending && wanted && <p className="quiet">Loading</p>}
        {data && found.length === 0 && <p>No other recorded run on {run.town}.</p>}
        {found.map((one) => (
          <button key={one.id} type="button" onClick={() => put({ with: one.id })}>
            <span>{one.label || one.id}</span>
            <span className="quiet">
              {one.agent}, {moment(one.created_at)}
            </span>
            <Mark {...lookOfRun(one)} />
          </button>
        ))}
      </div>
    </details>
  );
}

/** Runs of the same scenario are nearest, then those of the same name. */
function nearness(run: Schemas["Run"], other: Schemas["RunSummary"]): number {
  if (run.scenario_sha256 === other.scenario_sha256) return 2;
  return run.label !== "" && run.label === other.label ? 1 : 0;
}
