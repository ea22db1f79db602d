import { useState } from "react";
import type { Schemas } from "../../api/client";
import { Mark } from "../../components/Mark";
import { fixed } from "../../components/numbers";
import {
  alike,
  artefactsOf,
  blameWords,
  failuresOf,
  followingWords,
  gravestFirst,
  observedWords,
  oracleName,
  toneOf,
} from "./verdictWords";

type Verdict = Schemas["Verdict"];

const MOST = 6;

/** What the oracles found, the gravest first; a click goes to its moment. */
export function VerdictLine({
  run,
  untilOf,
  onMoment,
  rejudge = "",
}: {
  readonly run: Pick<Schemas["Run"], "verdicts" | "failing_verdicts" | "definition">;
  /** Last moment at which a violation could still be avoided, seconds. */
  readonly untilOf: (verdict: Verdict) => number | null;
  readonly onMoment: (time: number) => void;
  /** Command that judges the run again, if another version of the oracles has judged it. */
  readonly rejudge?: string;
}) {
  const [isUnfolded, unfold] = useState(false);
  const { verdicts, definition } = run;
  const failures = failuresOf(run);
  const violations = gravestFirst(verdicts, failures);
  const isFailure = (verdict: Verdict) => failures.includes(verdict);
  const following = violations.filter((one) => one.follows !== "" && !isFailure(one));
  const own = violations.filter((one) => !following.includes(one));
  const [first, ...others] = own.filter((one) => one.severity !== "observation" || isFailure(one));
  const observed = own.filter((one) => one !== first && !others.includes(one));
  const artefacts = artefactsOf(verdicts);
  const unclear = verdicts.filter(({ outcome }) => outcome === "not_measurable");
  const idle = verdicts.filter(({ outcome }) => outcome === "not_applicable");
  const rest = alike([...others, ...observed, ...(isUnfolded ? following : [])]);
  return (
    <div className="verdict-line whole-width">
      {artefacts.map(({ ego, message }) => (
        <Mark key={ego} sign="–" tone="lost" text={`${ego}: ${message}`} />
      ))}
      {first ? (
        <>
          <Violation verdict={first} until={untilOf(first)} onMoment={onMoment} whole />
          {!isFailure(first) && (
            <span className="quiet" title={definition && `Failures are ${definition.words}`}>
              does not count as a failure
            </span>
          )}
        </>
      ) : verdicts.length > unclear.length + idle.length ? (
        <span>
          <Mark sign="✓" tone="good" text="No oracle was violated" />
          {observed.length > 0 && (
            <span className="quiet" title="What was observed makes no run fail by itself">
              ; {observedWords(observed.length)}:
            </span>
          )}
        </span>
      ) : (
        <Mark sign="–" tone="lost" text="No oracle has judged the run" />
      )}
      {rest.slice(0, MOST).map(({ first: verdict, count }) => (
        <Violation
          key={verdict.oracle}
          verdict={verdict}
          count={count}
          until={untilOf(verdict)}
          onMoment={onMoment}
        />
      ))}
      {rest.length > MOST && (
        <span className="quiet">and {rest.length - MOST} oracles more, on the time line</span>
      )}
      {following.length > 0 && (
        <button
          type="button"
          className="plain"
          aria-expanded={isUnfolded}
          title="They only follow from another violation, and do not count beside it"
          onClick={() => unfold(!isUnfolded)}
        >
          {isUnfolded ? "Fold what follows" : followingWords(following)}
        </button>
      )}
      <Counted verdicts={unclear} words="not measurable" />
      <Counted verdicts={idle} words="with nothing to judge" />
      {rejudge && (
        <span className="quiet">
          judged by another version of the oracles; what changes by today's: <code>{rejudge}</code>
        </span>
      )}
    </div>
  );
}

/** How many verdicts have an outcome; which they are, and why, is in the tooltip. */
function Counted({
  verdicts,
  words,
}: {
  readonly verdicts: readonly Verdict[];
  readonly words: string;
}) {
  if (verdicts.length === 0) return null;
  return (
    <span
      className="quiet"
      title={verdicts.map(({ oracle, ego, message }) => `${oracle}, ${ego}: ${message}`).join("\n")}
    >
      {verdicts.length} {words}
    </span>
  );
}

function Violation({
  verdict,
  count = 1,
  until,
  onMoment,
  whole = false,
}: {
  readonly verdict: Verdict;
  /** How many there are of its oracle; the verdict is their first. */
  readonly count?: number;
  readonly until: number | null;
  readonly onMoment: (time: number) => void;
  readonly whole?: boolean;
}) {
  const observation = verdict.severity === "observation";
  const blame = blameWords(verdict, until);
  const { time } = verdict;
  const text = whole
    ? `${oracleName(verdict.oracle)}, ${verdict.ego}: ${verdict.message}`
    : `${oracleName(verdict.oracle)}${count > 1 ? ` ×${count}` : ""}`;
  return (
    <button
      type="button"
      className={whole ? "violation whole" : "violation"}
      title={`${verdict.ego}: ${verdict.message}${blame ? ` (${blame})` : ""}`}
      disabled={typeof time !== "number"}
      onClick={() => typeof time === "number" && onMoment(time)}
    >
      <Mark sign={observation ? "○" : "✕"} tone={toneOf(verdict)} text={text} />
      {whole && blame && <strong>{blame}</strong>}
      {typeof time === "number" && <span className="quiet">{fixed(time, 2)} s</span>}
    </button>
  );
}
