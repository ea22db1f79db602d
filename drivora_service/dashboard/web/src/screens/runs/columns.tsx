import { Link } from "@tanstack/react-router";
import type { Schemas } from "../../api/client";
import { adsHint } from "../../components/configuration";
import type { Column } from "../../components/DataTable";
import { Mark } from "../../components/Mark";
import { MiddleCut } from "../../components/MiddleCut";
import { count, fixed, moment } from "../../components/numbers";
import { ACCOUNTABILITY_WORDS } from "./filters";
import { lookOfRun } from "./status";

export type Run = Schemas["RunSummary"];

export const USUAL_COLUMNS = [
  "status",
  "label",
  "agent",
  "town",
  "violations",
  "at_fault",
  "sim_time_s",
  "created_at",
  "id",
] as const;

/** Returns all columns that the list of runs can show. */
export function runColumns(oldestFirst: boolean, onSort: () => void): readonly Column<Run>[] {
  return [
    { id: "status", title: "Result", width: "190px", cell: (run) => <Mark {...lookOfRun(run)} /> },
    {
      id: "label",
      title: "Label",
      width: "minmax(200px, 2.4fr)",
      cell: (run) => (run.label ? <MiddleCut text={run.label} /> : <Unnamed run={run} />),
    },
    {
      id: "agent",
      title: "ADS",
      width: "minmax(110px, 1fr)",
      cell: (run) => <SameAds run={run} />,
    },
    {
      id: "configuration_id",
      title: "ADS id",
      width: "90px",
      hint: "Short id of the ADS with all its parameters",
      cell: (run) => <code>{run.configuration_id}</code>,
    },
    {
      id: "town",
      title: "Town",
      width: "minmax(90px, 1fr)",
      cell: (run) => <Same name="town" value={run.town} />,
    },
    {
      id: "violations",
      title: "Violations",
      width: "84px",
      numeric: true,
      cell: (run) => count(run.violations),
    },
    {
      id: "at_fault",
      title: "At fault",
      width: "74px",
      numeric: true,
      hint: "Violations for which an ego is responsible",
      cell: (run) => count(run.at_fault_violations),
    },
    {
      id: "observations",
      title: "Observations",
      width: "98px",
      numeric: true,
      hint: "Violations of oracles that count only where they are named",
      cell: (run) => count(run.observations),
    },
    {
      id: "accountability",
      title: "Strongest fault",
      width: "150px",
      hint: "The strongest accountability of its violations",
      cell: (run) =>
        run.accountability ? ACCOUNTABILITY_WORDS[run.accountability] : <NotJudged run={run} />,
    },
    { id: "cause", title: "Cause", width: "minmax(140px, 1fr)", cell: (run) => run.cause },
    {
      id: "sim_time_s",
      title: "Simulated (s)",
      width: "108px",
      numeric: true,
      cell: (run) => fixed(run.sim_time_s, 1),
    },
    {
      id: "wall_time_s",
      title: "Took (s)",
      width: "76px",
      numeric: true,
      cell: (run) => fixed(run.wall_time_s, 2),
    },
    { id: "steps", title: "Steps", width: "70px", numeric: true, cell: (run) => count(run.steps) },
    {
      id: "attempts",
      title: "Attempts",
      width: "76px",
      numeric: true,
      cell: (run) => count(run.attempts),
    },
    {
      id: "seed",
      title: "Seed",
      width: "90px",
      numeric: true,
      hint: "Where it overrides the document's",
      cell: (run) => run.seed,
    },
    {
      id: "batch_id",
      title: "Batch",
      width: "200px",
      cell: (run) =>
        run.batch_id && (
          <Link to="/batches/$batchId" params={{ batchId: run.batch_id }}>
            <code>{run.batch_id}</code>
          </Link>
        ),
    },
    {
      id: "created_at",
      title: "Queued at",
      width: "162px",
      sorted: oldestFirst ? "ascending" : "descending",
      onSort,
      cell: (run) => moment(run.created_at),
    },
    { id: "ended_at", title: "Ended at", width: "162px", cell: (run) => moment(run.ended_at) },
    {
      id: "id",
      title: "Run",
      width: "200px",
      cell: (run) => (
        <Link to="/runs/$runId" params={{ runId: run.id }}>
          <code>
            <MiddleCut text={run.id} />
          </code>
        </Link>
      ),
    },
    {
      id: "scenario_sha256",
      title: "Scenario",
      width: "110px",
      hint: "Beginning of the document's hash",
      cell: (run) => (
        <Link
          to="/runs"
          search={{ scenario_sha256: run.scenario_sha256 }}
          title="Runs of the same scenario"
        >
          <code>{run.scenario_sha256.slice(0, 10)}</code>
        </Link>
      ),
    },
  ];
}

/** A value that leads to the runs that have it too. */
function Same({ name, value }: { readonly name: string; readonly value: string }) {
  return (
    <Link
      to="/runs"
      search={(now) => ({ ...now, [name]: value })}
      className="ink"
      title={`Only runs with ${value}`}
    >
      {value}
    </Link>
  );
}

/** The ADS with its parameters, which leads to the runs that it drove too. */
function SameAds({ run }: { readonly run: Run }) {
  if (!run.configuration_id) return <Same name="agent" value={run.agent} />;
  return (
    <Link
      to="/runs"
      search={(now) => ({ ...now, configuration: run.configuration_id })}
      className="ink"
      title={`Only runs with ${adsHint(run)}`}
    >
      {run.configuration}
    </Link>
  );
}

/** A run without a label is told by its scenario. */
function Unnamed({ run }: { readonly run: Run }) {
  return (
    <span className="quiet">
      {run.batch_id ? `${count(run.item + 1)} of its batch` : "scenario"}{" "}
      <code>{run.scenario_sha256.slice(0, 8)}</code>
    </span>
  );
}

function NotJudged({ run }: { readonly run: Run }) {
  return run.status === "finished" || run.violations ? null : (
    <span className="quiet">not judged</span>
  );
}
