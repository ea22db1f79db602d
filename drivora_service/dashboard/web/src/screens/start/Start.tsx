import type { ReactNode } from "react";
import { serviceAddress } from "../../service";
import { useTitle } from "../../shell/useTitle";
import { NewLink } from "../compose/NewLink";

/** What to do first, where nothing has run yet. */
export function Start() {
  useTitle("");
  const server = serviceAddress();
  return (
    <>
      <div className="head">
        <h1>Nothing has run yet</h1>
        <p className="answer">Each of these fills this page.</p>
      </div>
      <ol className="start">
        <Step
          title="Judge scenarios"
          command={`drivora run scenario.json --server ${server}`}
          says="Simulates each scenario with its ADS, judges it by all oracles, and shows it under Runs."
        />
        <Step
          title="Search for failures"
          command={`drivora campaign run campaign.yaml --server ${server}`}
          says="A tester varies a seed scenario until its budget is spent; failures appear as they are found."
        >
          <NewLink to="/campaigns/new">Compose a campaign</NewLink>
        </Step>
        <Step
          title="Compare ADSs and methods"
          command={`drivora study run study.yaml --server ${server}`}
          says="Runs campaigns by scenarios, ADSs, methods and repetitions."
        >
          <NewLink to="/studies/new" isShort>
            Compose a study
          </NewLink>
        </Step>
      </ol>
      <p className="quiet">
        No document at hand? <code>drivora schema --help</code> names the schemas, and{" "}
        <code>drivora demo</code> shows the whole process with examples.
      </p>
    </>
  );
}

function Step({
  title,
  command,
  says,
  children,
}: {
  readonly title: string;
  readonly command: string;
  readonly says: string;
  readonly children?: ReactNode;
}) {
  return (
    <li className="panel">
      <div className="inside">
        <h2>{title}</h2>
        <p className="quiet">{says}</p>
        {children}
        <pre>{command}</pre>
      </div>
    </li>
  );
}
