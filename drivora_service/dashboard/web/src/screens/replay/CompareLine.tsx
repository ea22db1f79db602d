import { Link } from "@tanstack/react-router";
import type { Schemas } from "../../api/client";
import { Ads } from "../../components/Ads";
import { Mark } from "../../components/Mark";
import { fixed } from "../../components/numbers";
import { lookOfRun } from "../runs/status";
import { avoidableUntil } from "./avoidable";
import { type Pace, type Parting, partingWords } from "./difference";
import { blameWords, failuresOf, gravestFirst, oracleName, toneOf } from "./verdictWords";
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
        {other && (
          <span className="quiet">
            <Ads of={other} />
          </span>
        )}
      </span>
      {other && <Mark {...lookOfRun(other)} />}
      {other && <Gravest run={other} />}
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

/** The gravest violation of the other run, as its verdict says it. */
function Gravest({ run }: { readonly run: Schemas["Run"] }) {
  const failures = failuresOf(run);
  const gravest = gravestFirst(run.verdicts, failures).find(
    (one) => one.severity !== "observation" || failures.includes(one),
  );
  if (!gravest) return null;
  const { oracle, ego, message, time } = gravest;
  const blame = blameWords(gravest, avoidableUntil(gravest));
  return (
    <span className="gravest">
      <Mark sign="✕" tone={toneOf(gravest)} text={`${oracleName(oracle)}, ${ego}: ${message}`} />
      {blame && <strong>{blame}</strong>}
      {typeof time === "number" && <span className="quiet">{fixed(time, 2)} s</span>}
    </span>
  );
}

/** Which of two runs a map shows. */
export function Caption({ place, run }: { readonly place: string; readonly run: Schemas["Run"] }) {
  return (
    <>
      <span className="quiet">{place}</span>
      <b>{run.label || run.id}</b>
      <Ads of={run} />
    </>
  );
}
