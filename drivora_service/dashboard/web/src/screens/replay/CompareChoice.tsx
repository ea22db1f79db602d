import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import type { Schemas } from "../../api/client";
import { Ads } from "../../components/Ads";
import { Mark } from "../../components/Mark";
import { moment } from "../../components/numbers";
import { lookOfRun } from "../runs/status";
import { choicesOf, MOST_OFFERED, pastedId } from "./compareChoices";
import { recordedRuns } from "./recordedRuns";
import { runQuery } from "./runQuery";
import "./compare.css";

type Summary = Schemas["RunSummary"];

/** Chooses a run to compare with: those of the same scenario come first, however old they are. */
export function CompareChoice({
  run,
  put,
}: {
  readonly run: Schemas["Run"];
  readonly put: (changes: { readonly with: string }) => void;
}) {
  const [wanted, setWanted] = useState(false);
  const [words, setWords] = useState("");
  const { scenario_sha256, town } = run;
  const hasScenario = scenario_sha256 !== "";
  const ofScenario = useQuery({
    ...recordedRuns({ scenario_sha256 }),
    enabled: wanted && hasScenario,
  });
  const ofNetwork = useQuery({ ...recordedRuns({ town }), enabled: wanted });
  const isPending = (hasScenario && ofScenario.isPending) || ofNetwork.isPending;
  const error = ofScenario.error ?? ofNetwork.error;
  const pasted = pastedId(words);
  const groups = choicesOf(
    run,
    ofScenario.data ?? [],
    ofNetwork.data ?? [],
    pasted === "" ? words : pasted,
  );
  const found = groups.scenario.length + groups.network.length;
  const choose = (id: string) => put({ with: id });
  return (
    <details className="choice" onToggle={(event) => setWanted(event.currentTarget.open)}>
      <summary className="button">Compare…</summary>
      <div className="list">
        <input
          type="search"
          aria-label="Find a run to compare with"
          placeholder="Label or ADS, or the id of any run"
          value={words}
          onChange={(event) => setWords(event.target.value)}
        />
        {isPending && wanted && <p className="quiet">Loading</p>}
        {error && <p role="alert">{error.message}</p>}
        {!isPending && found === 0 && pasted === "" && (
          <p>
            {words.trim() === ""
              ? `No other recorded run on ${town}.`
              : `No other recorded run on ${town} has these words.`}
          </p>
        )}
        {!isPending && found === 0 && pasted !== "" && (
          <Pasted id={pasted} run={run} onChoose={choose} />
        )}
        <Group title="Runs of this scenario" runs={groups.scenario} onChoose={choose} />
        <Group title={`Other runs on ${town}`} runs={groups.network} onChoose={choose} />
      </div>
    </details>
  );
}

/** The run of an id that is in no list, or why it cannot be compared. */
function Pasted({
  id,
  run,
  onChoose,
}: {
  readonly id: string;
  readonly run: Schemas["Run"];
  readonly onChoose: (id: string) => void;
}) {
  const { data, error } = useQuery({ ...runQuery(id), retry: false });
  if (id === run.id) return <p>This is the run that is shown.</p>;
  if (error) return <p role="alert">{error.message}</p>;
  if (!data) return <p className="quiet">Loading</p>;
  if (data.town !== run.town)
    return (
      <p>
        That run is on {data.town}, this one on {run.town}.
      </p>
    );
  if (!data.trace_sha256) return <p>That run has no recording. Run it again from its page.</p>;
  return <Group title="The run of this id" runs={[data]} onChoose={onChoose} />;
}

function Group({
  title,
  runs,
  onChoose,
}: {
  readonly title: string;
  readonly runs: readonly Summary[];
  readonly onChoose: (id: string) => void;
}) {
  if (runs.length === 0) return null;
  return (
    <section aria-label={title}>
      <h3>{title}</h3>
      {runs.slice(0, MOST_OFFERED).map((one) => (
        <button key={one.id} type="button" onClick={() => onChoose(one.id)} title={one.id}>
          <span>{one.label || one.id}</span>
          <Mark {...lookOfRun(one)} />
          <span className="quiet">
            <Ads of={one} />
            {one.seed !== null && `, seed ${one.seed}`}
          </span>
          <span className="quiet">{moment(one.created_at)}</span>
        </button>
      ))}
      {runs.length > MOST_OFFERED && (
        <p className="quiet">And {runs.length - MOST_OFFERED} more: find them by their label.</p>
      )}
    </section>
  );
}
