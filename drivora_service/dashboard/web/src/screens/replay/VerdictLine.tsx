import type { Schemas } from "../../api/client";
import { Mark } from "../../components/Mark";
import { fixed } from "../../components/numbers";
import {
  alike,
  artefactsOf,
  blameWords,
  gravestFirst,
  observedWords,
  oracleName,
  toneOf,
} from "./verdictWords";

type Verdict = Schemas["Verdict"];

const MOST = 6;

/** What the oracles found, the gravest first; a click goes to its moment. */
export function VerdictLine({
  verdicts,
  untilOf,
  onMoment,
}: {
  readonly verdicts: readonly Verdict[];
  /** Last moment at which a violation could still be avoided, seconds. */
  readonly untilOf: (verdict: Verdict) => number | null;
  readonly onMoment: (time: number) => void;
}) {
  const violations = gravestFirst(verdicts);
  const [first, ...others] = violations.filter(({ severity }) => severity !== "observation");
  const observed = violations.filter(({ severity }) => severity === "observation");
  const artefacts = artefactsOf(verdicts);
  const unclear = verdicts.filter(({ outcome }) => outcome === "not_measurable");
  const rest = alike([...others, ...observed]);
  return (
    <div className="verdict-line whole-width">
      {artefacts.map(({ ego, message }) => (
        <Mark key={ego} sign="–" tone="lost" text={`${ego}: ${message}`} />
      ))}
      {first ? (
        <Violation verdict={first} until={untilOf(first)} onMoment={onMoment} whole />
      ) : verdicts.length > unclear.length ? (
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
      {unclear.length > 0 && (
        <span
          className="quiet"
          title={unclear
            .map(({ oracle, ego, message }) => `${oracle}, ${ego}: ${message}`)
            .join("\n")}
        >
          {unclear.length} not measurable
        </span>
      )}
    </div>
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
