import { Link } from "@tanstack/react-router";
import type { ReactNode } from "react";
import { fieldId } from "../../components/fields/Field";
import { ancestry, type PlacedProblem } from "../../components/fields/pointers";
import { Mark } from "../../components/Mark";
import { Prose } from "../../components/Prose";
import { Refused } from "../../components/States";
import { useScope } from "../../shell/session";
import type { Validation } from "./useValidation";

/** Goes to the field of a problem, or to the part of the form that is next to its place. */
export function jumpTo(pointer: string): void {
  for (const place of ancestry(pointer)) {
    const field = document.getElementById(fieldId(place));
    if (!field) continue;
    for (let around = field.parentElement; around; around = around.parentElement)
      if (around instanceof HTMLDetailsElement) around.open = true;
    field.scrollIntoView({ block: "center" });
    field.focus({ preventScroll: true });
    return;
  }
}

/** Whether it can be started, what is wrong, and the button that starts it. */
export function Outcome<Answer extends { readonly notes: readonly string[] }>({
  action,
  counted,
  hasScenario,
  validation,
  ready,
  estimate,
  canStart,
  error,
  onStart,
}: {
  /** The words of the button. */
  readonly action: string;
  /** What counts as a failure, in words. */
  readonly counted: string;
  readonly hasScenario: boolean;
  readonly validation: Validation<Answer>;
  /** What can be started, in words. */
  readonly ready: (answer: Answer) => string;
  readonly estimate: ReactNode;
  readonly canStart: boolean;
  /** Why it was not started. */
  readonly error: Error | null;
  readonly onStart: () => void;
}) {
  const { maySubmit } = useScope();
  const { answer, problems, isFresh } = validation;
  return (
    <section className="panel" aria-label="Start">
      <div className="inside stack">
        <div role="status" className="readiness" data-fresh={isFresh}>
          {!maySubmit ? (
            <NotAllowed />
          ) : !hasScenario ? (
            "Choose a scenario to begin."
          ) : problems.length > 0 ? (
            <Mark
              sign="⚠"
              tone="lost"
              text={problems.length === 1 ? "1 problem" : `${problems.length} problems`}
            />
          ) : validation.error ? (
            <Mark sign="⚠" tone="lost" text="Not checked" />
          ) : answer ? (
            <Mark sign="✓" tone="good" text={ready(answer)} />
          ) : (
            "Checking"
          )}
        </div>
        {hasScenario && maySubmit && <ProblemList problems={problems} />}
        {validation.error && maySubmit && (
          <p className="problem">
            <span>
              {validation.error.message}{" "}
              <button type="button" onClick={validation.again}>
                Check again
              </button>
            </span>
          </p>
        )}
        {answer && (
          <>
            {estimate}
            <Notes notes={answer.notes} />
          </>
        )}
        {hasScenario && <Counted words={counted} />}
        <button
          type="button"
          className="primary start-button"
          title="Ctrl+Enter"
          disabled={!canStart}
          onClick={onStart}
        >
          {action}
        </button>
        {error && <Refused error={error} />}
      </div>
    </section>
  );
}

/** What will count as a failure; a press leads to its choice. */
function Counted({ words }: { readonly words: string }) {
  return (
    <p>
      Counts: {words}{" "}
      <button type="button" className="plain change" onClick={() => jumpTo("/oracles")}>
        Change
      </button>
    </p>
  );
}

function NotAllowed() {
  return (
    <>
      Your token may read only. Starting needs one with the scope <code>submit</code>:{" "}
      <Link to="/session" search={{}}>
        sign in with another
      </Link>
      , or run the document by the command below.
    </>
  );
}

function ProblemList({ problems }: { readonly problems: readonly PlacedProblem[] }) {
  if (problems.length === 0) return null;
  return (
    <ul className="problems" aria-label="Problems">
      {problems.map(({ pointer, message }) => (
        <li key={`${pointer} ${message}`}>
          <button type="button" className="plain" onClick={() => jumpTo(pointer)}>
            <code>{pointer || "/"}</code>
          </button>{" "}
          <Prose text={message} />
        </li>
      ))}
    </ul>
  );
}

function Notes({ notes }: { readonly notes: readonly string[] }) {
  if (notes.length === 0) return null;
  return (
    <ul className="problems quiet" aria-label="Notes">
      {notes.map((note) => (
        <li key={note}>
          <Prose text={note} />
        </li>
      ))}
    </ul>
  );
}
