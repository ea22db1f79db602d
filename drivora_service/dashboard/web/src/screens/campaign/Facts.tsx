import { Link } from "@tanstack/react-router";
import type { ReactNode } from "react";
import type { Schemas } from "../../api/client";
import { Ads } from "../../components/Ads";
import { count, duration } from "../../components/numbers";
import { Progress } from "../../components/Progress";
import { useDiscoveries } from "../campaigns/discoveries";
import { CURVE_POINTS } from "./Found";

/** What a campaign searches, and how far it is. */
export function Facts({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const { tester, town, study_id, cell, simulations, budget, rate, left_s, state } = campaign;
  return (
    <dl className="head-facts">
      <Fact name="Method">{cell?.method ?? tester}</Fact>
      <Fact name="ADS">
        <Ads of={campaign} {...(cell ? { label: cell.agent } : {})} />
      </Fact>
      <Fact name="Scene">{cell?.scenario ?? town}</Fact>
      {study_id && (
        <Fact name="Part of">
          <Link to="/studies/$id" params={{ id: study_id }} search={{}}>
            its study
          </Link>
        </Fact>
      )}
      <Fact name="Simulations">
        <Progress done={simulations} of={budget} />
      </Fact>
      {simulations > 0 && <FirstFailure id={campaign.id} />}
      {rate !== null && <Fact name="Rate">{rate.toFixed(1)} simulations a second</Fact>}
      {state === "running" &&
        (simulations >= budget ? (
          <Fact name="Now">runs the failures a second time</Fact>
        ) : (
          left_s !== null && <Fact name="Time left">{duration(left_s)}</Fact>
        ))}
    </dl>
  );
}

/** The number that the list of campaigns has, too, and the evaluation behind it. */
function FirstFailure({ id }: { readonly id: string }) {
  const { data } = useDiscoveries(id, CURVE_POINTS, 1);
  if (!data || data.first_failure === null) return null;
  const found = data.oracles.find(({ first }) => first === data.first_failure);
  const words = `in simulation ${count(data.first_failure)}`;
  return (
    <Fact name="First failure">
      {found ? (
        <Link
          to="."
          search={{ tab: "ancestry", number: String(found.first_evaluation) }}
          title={`Evaluation ${found.first_evaluation}; evaluations are numbered from 0`}
          resetScroll={false}
        >
          {words}
        </Link>
      ) : (
        words
      )}
    </Fact>
  );
}

function Fact({ name, children }: { readonly name: string; readonly children: ReactNode }) {
  return (
    <div>
      <dt>{name}</dt>
      <dd>{children}</dd>
    </div>
  );
}
