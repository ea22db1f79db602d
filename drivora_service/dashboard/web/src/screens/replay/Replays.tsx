import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import type { Schemas } from "../../api/client";
import { Ads } from "../../components/Ads";
import { moment } from "../../components/numbers";
import { originOf } from "./compareChoices";
import { RunAgain } from "./RunAgain";
import { recordedRuns } from "./recordedRuns";

const SHOWN = 5;

/** The recorded runs of the scenario of a run that has no recording, and a button for another. */
export function Replays({ run }: { readonly run: Schemas["Run"] }) {
  const { scenario_sha256 } = run;
  const { data } = useQuery({
    ...recordedRuns({ scenario_sha256 }),
    enabled: scenario_sha256 !== "",
  });
  const others = (data ?? []).filter(({ id }) => id !== run.id);
  const ofRun = others.filter((one) => originOf(one) === run.id);
  const shown = [...ofRun, ...others.filter((one) => !ofRun.includes(one))].slice(0, SHOWN);
  return (
    <>
      {shown.length > 0 && (
        <section aria-label="Recorded runs of this scenario">
          <p>{ofRun.length > 0 ? "Its replays:" : "Recorded runs of the same scenario:"}</p>
          <ul className="replays">
            {shown.map((one) => (
              <li key={one.id}>
                <Link to="/runs/$runId" params={{ runId: one.id }} search={{}}>
                  {one.label || one.id}
                </Link>{" "}
                <span className="quiet">
                  <Ads of={one} />, {moment(one.created_at)}
                </span>
              </li>
            ))}
          </ul>
          {others.length > shown.length && (
            <p>
              <Link to="/runs" search={{ scenario_sha256 }}>
                All runs of this scenario
              </Link>
            </p>
          )}
        </section>
      )}
      <RunAgain id={run.id} isMain={shown.length === 0} />
    </>
  );
}
