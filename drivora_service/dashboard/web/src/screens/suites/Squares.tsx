import { Link } from "@tanstack/react-router";
import { useState } from "react";
import { Mark } from "../../components/Mark";
import { count, moment } from "../../components/numbers";
import {
  alwaysPasses,
  driverOf,
  type History,
  lookOfGate,
  type Outcome,
  type ScenarioState,
  STATES,
  type SuiteRun,
} from "./suite";

const MOST = 400;

/** The history of each scenario as a strip of squares, oldest to newest; each leads to its run. */
export function Squares({
  history,
  chosen,
  onChoose,
}: {
  readonly history: History;
  /** Places of the runs that are compared. */
  readonly chosen: readonly number[];
  readonly onChoose: (run: string) => void;
}) {
  const [all, setAll] = useState(false);
  const telling = history.scenarios.filter((line) => !alwaysPasses(line));
  const lines = (all ? history.scenarios : telling).slice(0, MOST);
  const hidden = history.scenarios.length - telling.length;
  return (
    <section aria-label="History of scenarios">
      <h2>Scenarios, run by run</h2>
      <p className="answer">
        {count(telling.length)} of {count(history.scenarios.length)} did not always pass.{" "}
        {hidden > 0 && (
          <button type="button" className="plain" onClick={() => setAll(!all)}>
            {all ? "Hide those that always pass" : `Show the ${count(hidden)} others`}
          </button>
        )}
      </p>
      <div className="plain-table squares">
        <table>
          <thead>
            <tr>
              <th scope="col">Scenario</th>
              {history.runs.map((run, place) => (
                <th key={run.id} scope="col" data-chosen={chosen.includes(place)}>
                  <button
                    type="button"
                    className="plain"
                    data-tone={lookOfGate(run).tone}
                    title={runWords(run)}
                    aria-label={`Compare with the run of ${moment(run.created_at)}`}
                    disabled={place === history.runs.length - 1}
                    onClick={() => onChoose(run.id)}
                  >
                    {lookOfGate(run).sign}
                  </button>
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {lines.map(({ scenario, outcomes }) => (
              <tr key={scenario}>
                <th scope="row">{scenario}</th>
                {outcomes.map((outcome, place) => (
                  <td key={history.runs[place]?.id} data-chosen={chosen.includes(place)}>
                    {outcome && <Square outcome={outcome} run={history.runs[place]} />}
                  </td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <p className="legend">
        {(Object.keys(STATES) as ScenarioState[]).map((state) => (
          <Mark key={state} {...STATES[state]} />
        ))}
      </p>
    </section>
  );
}

function Square({
  outcome,
  run,
}: {
  readonly outcome: Outcome;
  readonly run: SuiteRun | undefined;
}) {
  const { sign, tone, text } = STATES[outcome.state];
  const words = [`${text}, ${moment(run?.created_at).slice(0, 16)}`, ...outcome.failures].join(
    "\n",
  );
  if (!outcome.run_id)
    return (
      <span className="square" data-tone={tone} title={words}>
        {sign}
      </span>
    );
  return (
    <Link
      className="square"
      data-tone={tone}
      title={words}
      aria-label={`${outcome.scenario}: ${words}`}
      to="/runs/$runId"
      params={{ runId: outcome.run_id }}
      search={{}}
    >
      {sign}
    </Link>
  );
}

function runWords(run: SuiteRun): string {
  return `${moment(run.created_at)}, ${driverOf(run)}\n${run.sentence}`;
}
