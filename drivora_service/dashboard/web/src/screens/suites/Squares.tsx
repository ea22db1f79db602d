import { Link } from "@tanstack/react-router";
import { useState } from "react";
import { count } from "../../components/numbers";
import {
  alwaysPasses,
  type History,
  lookOfGate,
  type Outcome,
  type RunName,
  type ScenarioState,
  STATES,
  type SuiteRun,
} from "./suite";

const MOST = 400;

/** The history of each scenario as a strip of squares, oldest to newest; each leads to its run. */
export function Squares({
  history,
  names,
  before,
  after,
  onChoose,
}: {
  readonly history: History;
  readonly names: readonly RunName[];
  /** Places of the runs that are compared; the old one is -1 where there is none. */
  readonly before: number;
  readonly after: number;
  readonly onChoose: (chosen: { readonly before?: string; readonly after?: string }) => void;
}) {
  const [all, setAll] = useState(false);
  const telling = history.scenarios.filter((line) => !alwaysPasses(line));
  const lines = (all ? history.scenarios : telling).slice(0, MOST);
  const isChosen = (place: number) => before >= 0 && (place === before || place === after);
  const hidden = history.scenarios.length - telling.length;
  return (
    <section aria-label="History of scenarios">
      <h2>Scenarios, run by run</h2>
      <p className="answer">
        {count(telling.length)} of {count(history.scenarios.length)} did not always pass.{" "}
        {hidden > 0 && (
          <button type="button" onClick={() => setAll(!all)}>
            {all ? "Hide those that always pass" : `Show the ${count(hidden)} others`}
          </button>
        )}
      </p>
      {before >= 0 && (
        <p className="compared">
          <RunChoice
            title="Old"
            value={before}
            places={history.runs.flatMap((_, place) => (place < after ? [place] : []))}
            history={history}
            names={names}
            onChoose={(id) => onChoose({ before: id })}
          />
          <RunChoice
            title="New"
            value={after}
            places={history.runs.flatMap((_, place) => (place > 0 ? [place] : []))}
            history={history}
            names={names}
            onChoose={(id) => onChoose({ after: id })}
          />
        </p>
      )}
      <div className="plain-table squares">
        <table>
          <thead>
            <tr>
              <th scope="col">Scenario</th>
              {history.runs.map((run, place) => (
                <th
                  key={run.id}
                  scope="col"
                  data-chosen={isChosen(place)}
                  title={runWords(run, names[place])}
                >
                  <span className="run-name">
                    <b>{names[place]?.driver}</b> {names[place]?.when}
                  </span>
                  <span className="gate" data-tone={lookOfGate(run).tone}>
                    {lookOfGate(run).sign}
                    <span className="hidden-visually">{lookOfGate(run).text}</span>
                  </span>
                  <small>{isChosen(place) ? (place === before ? "old" : "new") : "\u00a0"}</small>
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {lines.map(({ scenario, outcomes }) => (
              <tr key={scenario}>
                <th scope="row">{scenario}</th>
                {outcomes.map((outcome, place) => (
                  <td key={history.runs[place]?.id} data-chosen={isChosen(place)}>
                    {outcome && <Square outcome={outcome} name={names[place]} />}
                  </td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <p className="legend squares">
        {(Object.keys(STATES) as ScenarioState[]).map((state) => (
          <span key={state}>
            <span className="square" data-tone={STATES[state].tone}>
              {STATES[state].sign}
            </span>{" "}
            {STATES[state].text}
          </span>
        ))}
      </p>
    </section>
  );
}

function Square({
  outcome,
  name,
}: {
  readonly outcome: Outcome;
  readonly name: RunName | undefined;
}) {
  const { sign, tone, text } = STATES[outcome.state];
  const words = [`${text}, ${name?.whole}`, ...outcome.failures].join("\n");
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

/** Chooses one of the runs that are compared. */
function RunChoice({
  title,
  value,
  places,
  history,
  names,
  onChoose,
}: {
  readonly title: string;
  readonly value: number;
  readonly places: readonly number[];
  readonly history: History;
  readonly names: readonly RunName[];
  readonly onChoose: (id: string) => void;
}) {
  return (
    <label>
      {title}{" "}
      <select
        aria-label={`${title} run`}
        value={history.runs[value]?.id}
        onChange={(event) => onChoose(event.target.value)}
      >
        {places.toReversed().map((place) => (
          <option key={history.runs[place]?.id} value={history.runs[place]?.id}>
            {names[place]?.whole}
          </option>
        ))}
      </select>
    </label>
  );
}

function runWords(run: SuiteRun, name: RunName | undefined): string {
  return `${name?.whole}: ${lookOfGate(run).text}\n${run.sentence}`;
}
