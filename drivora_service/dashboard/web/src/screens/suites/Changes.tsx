import { Link } from "@tanstack/react-router";
import { Mark } from "../../components/Mark";
import {
  changeSentence,
  type Outcome,
  type RunName,
  type ScenarioLine,
  STATES,
  type Turn,
} from "./suite";

/** The scenarios that changed between two runs of a suite, with both replays in step. */
export function Changes({
  names,
  before,
  after,
  changes,
}: {
  readonly names: readonly RunName[];
  readonly before: number;
  readonly after: number;
  readonly changes: readonly { readonly line: ScenarioLine; readonly turn: Turn }[];
}) {
  return (
    <section aria-label="Old against new">
      <h2>
        Old: {names[before]?.whole}. New: {names[after]?.whole}
      </h2>
      <p className="answer">{changeSentence(changes)}</p>
      {changes.length > 0 && (
        <div className="plain-table">
          <table>
            <thead>
              <tr>
                <th scope="col">Scenario</th>
                <th scope="col">Old</th>
                <th scope="col">New</th>
                <th scope="col">What fails</th>
                <th scope="col">Runs</th>
              </tr>
            </thead>
            <tbody>
              {changes.map(({ line }) => (
                <Row
                  key={line.scenario}
                  scenario={line.scenario}
                  before={line.outcomes[before] ?? null}
                  now={line.outcomes[after] ?? null}
                />
              ))}
            </tbody>
          </table>
        </div>
      )}
    </section>
  );
}

function Row({
  scenario,
  before,
  now,
}: {
  readonly scenario: string;
  readonly before: Outcome | null;
  readonly now: Outcome | null;
}) {
  if (!before || !now) return null;
  const told = now.failures[0] ?? before.failures[0] ?? "";
  return (
    <tr>
      <th scope="row">{scenario}</th>
      <td>
        <Mark {...STATES[before.state]} />
      </td>
      <td>
        <Mark {...STATES[now.state]} />
      </td>
      <td>{told}</td>
      <td className="links">
        {now.run_id && before.run_id ? (
          <Link
            to="/runs/$runId"
            params={{ runId: now.run_id }}
            search={{ with: before.run_id, view: "side" }}
          >
            Both, in step
          </Link>
        ) : (
          <span className="quiet">not run</span>
        )}
      </td>
    </tr>
  );
}
