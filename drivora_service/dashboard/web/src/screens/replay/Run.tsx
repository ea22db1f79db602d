import { useQuery } from "@tanstack/react-query";
import { Link, useParams } from "@tanstack/react-router";
import type { Schemas } from "../../api/client";
import { Ads } from "../../components/Ads";
import { Copy } from "../../components/Copy";
import { type Column, DataTable } from "../../components/DataTable";
import { Mark, type MarkLook } from "../../components/Mark";
import { fixed, moment } from "../../components/numbers";
import { Empty, Loading, Refused } from "../../components/States";
import { fileNameOf } from "../../documents/files";
import { useTitle } from "../../shell/useTitle";
import { SearchFrom } from "../compose/SearchFrom";
import { plain } from "../failures/words";
import { minimizationOf } from "../minimizations/minimization";
import { lookOfRun } from "../runs/status";
import { againCommand } from "./againCommand";
import { avoidableUntil } from "./avoidable";
import { originOf } from "./compareChoices";
import { Minimised, MinimizeRun } from "./MinimizeRun";
import { Replay } from "./Replay";
import { Replays } from "./Replays";
import { runQuery } from "./runQuery";
import { blameWords, failuresOf, gravestFirst, oracleName, toneOf } from "./verdictWords";
import "./replay.css";
import { addressOf, serviceAddress } from "../../service";

/** A run: its replay, or why there is none. */
export function Run() {
  const { runId } = useParams({ from: "/runs/$runId" });
  const { data: run, error, isPending, refetch } = useQuery(runQuery(runId));
  useTitle(run?.label || `Run ${runId}`);
  if (isPending) return <Loading rows={14} />;
  if (error) return <Refused error={error} onRepeat={() => void refetch()} />;
  return (
    <>
      <div className="head run-head">
        <h1 title={run.label || run.id}>{run.label || run.id}</h1>
        <Mark {...lookOfRun(run)} />
        <p className="answer">
          <Ads of={run} /> on{" "}
          <Link to="/networks/$name" params={{ name: run.town }} search={{}}>
            {run.town}
          </Link>
          {run.seed !== null && `, seed ${run.seed}`} <Origin run={run} />
        </p>
        <div className="actions">
          <MinimizeRun run={run} />
          <SearchFrom search={{ run: run.id }} />
          <span className="copies-id">
            <Copy text={run.id} label="Copy the id" />
          </span>
          <span className="copies-command">
            <Copy
              text={againCommand(run, serviceAddress())}
              label="Copy the command that runs it again"
            />
          </span>
          <Link
            to="/author"
            search={{ run: run.id }}
            className="button"
            title="Change the scenario on the map, and run it"
          >
            Edit
          </Link>
          <a
            className="button"
            href={addressOf(`/api/v1/runs/${run.id}/scenario`)}
            download={`${fileNameOf(run.label || run.id)}.json`}
            title="Save the scenario of this run as a file"
          >
            Scenario
          </a>
        </div>
      </div>
      {run.trace_sha256 && run.status !== "finished" && <NotJudged run={run} />}
      {run.trace_sha256 ? <Replay key={run.id} run={run} /> : <NoRecording run={run} />}
    </>
  );
}

/** Where a run comes from, and what else was run of its scenario. */
function Origin({ run }: { readonly run: Schemas["Run"] }) {
  const minimization = minimizationOf(run.id);
  const origin = originOf(run);
  return (
    <>
      {origin && (
        <>
          {" · "}
          <Link to="/runs/$runId" params={{ runId: origin }} search={{}}>
            the run that it repeats
          </Link>
        </>
      )}
      {" · "}
      {minimization ? (
        <Link to="/minimizations/$id" params={{ id: minimization }} search={{}}>
          its minimisation
        </Link>
      ) : run.campaign_id ? (
        <Link
          to="/campaigns/$id"
          params={{ id: run.campaign_id }}
          search={
            run.evaluation === null ? {} : { tab: "ancestry", number: String(run.evaluation) }
          }
        >
          its campaign
        </Link>
      ) : (
        <Link to="/batches/$batchId" params={{ batchId: run.batch_id }}>
          its batch
        </Link>
      )}
      {" · "}
      <Link to="/runs" search={{ scenario_sha256: run.scenario_sha256 }}>
        runs of this scenario
      </Link>
      <Minimised run={run} />
    </>
  );
}

/** What a run without a judgement says above its replay: it neither passes nor fails. */
function NotJudged({ run }: { readonly run: Schemas["Run"] }) {
  return (
    <p role="note">
      <Mark {...lookOfRun(run)} /> Not judged{run.cause && `: ${run.cause.replaceAll("_", " ")}`}
      {run.error && `. ${run.error.message}`}
    </p>
  );
}

function NoRecording({ run }: { readonly run: Schemas["Run"] }) {
  const { status } = run;
  if (status === "queued")
    return (
      <Empty title="The run waits in the queue">
        <p>Queued at {moment(run.created_at)}. This page shows it as soon as it has been driven.</p>
      </Empty>
    );
  if (status === "running")
    return (
      <Empty title="The run is being driven">
        <p>Since {moment(run.started_at)}. This page shows it as soon as it has ended.</p>
      </Empty>
    );
  if (status === "finished")
    return (
      <>
        <Verdicts run={run} />
        <Empty
          title="The run was not recorded, or its recording was pruned"
          command={againCommand(run, serviceAddress())}
        >
          <p>
            Its verdicts are kept. Run again, it is recorded and can be seen; the command compares
            both runs as well.
          </p>
          <Replays run={run} />
        </Empty>
      </>
    );
  return (
    <Empty
      title={`Not judged: ${lookOfRun(run).text}`}
      command={againCommand(run, serviceAddress())}
    >
      {run.cause && <p>{run.cause.replaceAll("_", " ")}</p>}
      {run.error && <p>{run.error.message}</p>}
      <p>A run like this neither passes nor fails. The command runs it again, too.</p>
      <Replays run={run} />
    </Empty>
  );
}

const OUTCOMES: Readonly<Record<Schemas["Outcome"], MarkLook>> = {
  passed: { sign: "✓", tone: "good", text: "passed" },
  violated: { sign: "✕", tone: "bad", text: "violated" },
  not_applicable: { sign: "·", tone: "quiet", text: "nothing to judge" },
  not_measurable: { sign: "–", tone: "lost", text: "not measurable" },
};

/** A violation that is no failure by itself. */
const OBSERVED: MarkLook = { sign: "○", tone: "quiet", text: "observed" };

/** All verdicts of a run without a recording, the violations first. */
function Verdicts({ run }: { readonly run: Schemas["Run"] }) {
  const { verdicts } = run;
  const rows = [
    ...gravestFirst(verdicts, failuresOf(run)),
    ...verdicts.filter(({ outcome }) => outcome === "not_measurable"),
    ...verdicts.filter(({ outcome }) => outcome === "passed"),
    ...verdicts.filter(({ outcome }) => outcome === "not_applicable"),
  ];
  return (
    <DataTable label="Verdicts" columns={VERDICTS} rows={rows} idOf={verdictId} height="50vh" />
  );
}

function verdictId({ oracle, ego, time, counterpart }: Schemas["Verdict"]): string {
  return `${oracle} ${ego} ${time ?? ""} ${counterpart ?? ""}`;
}

const VERDICTS: readonly Column<Schemas["Verdict"]>[] = [
  { id: "oracle", title: "Oracle", width: "150px", cell: ({ oracle }) => oracleName(oracle) },
  { id: "ego", title: "Ego", width: "90px", cell: ({ ego }) => ego },
  {
    id: "outcome",
    title: "Outcome",
    width: "130px",
    cell: ({ outcome, severity, at_fault = null }) => (
      <Mark
        {...(outcome !== "violated"
          ? OUTCOMES[outcome]
          : severity === "observation"
            ? OBSERVED
            : { ...OUTCOMES.violated, tone: toneOf({ severity, at_fault }) })}
      />
    ),
  },
  {
    id: "time",
    title: "At (s)",
    width: "70px",
    numeric: true,
    cell: ({ time }) => fixed(time, 2),
  },
  {
    id: "blame",
    title: "Fault",
    width: "260px",
    cell: (verdict) => blameWords(verdict, avoidableUntil(verdict)),
  },
  {
    id: "message",
    title: "Finding",
    width: "minmax(240px, 1fr)",
    cell: ({ message, follows }) => {
      const text = follows ? `${message} (follows from ${plain(follows)})` : message;
      return <span title={text}>{text}</span>;
    },
  },
];
