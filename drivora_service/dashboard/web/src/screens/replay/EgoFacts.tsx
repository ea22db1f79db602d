import { Fragment, type ReactNode } from "react";
import { fixed } from "../../components/numbers";
import type { Clock } from "./clock";
import type { PerceivedActors } from "./perception";
import type { AgentTold } from "./plans";
import type { Recording } from "./recording";
import { useStep } from "./useMoment";
import type { Series } from "./useSeries";

const DEGREES = 180 / Math.PI;

const LIGHTS = ["", "green", "yellow", "red"] as const;

/** The ego's state and what its agent asks for, at the time. */
export function EgoFacts({
  recording,
  clock,
  ego,
  series,
  perceived,
  told,
}: {
  readonly recording: Recording;
  readonly clock: Clock;
  readonly ego: number;
  readonly series: Series | undefined;
  readonly perceived: PerceivedActors | undefined;
  readonly told: AgentTold | undefined;
}) {
  const step = Math.min(useStep(clock), recording.loaded - 1);
  const cell = step * recording.actors.length + ego;
  const own = step * recording.egos + ego;
  const number = (value: number | undefined, digits: number, unit: string) =>
    value === undefined || Number.isNaN(value) ? (
      <span className="quiet">not applicable</span>
    ) : (
      `${fixed(value, digits)} ${unit}`
    );
  const speed = recording.speed[cell];
  const absent = Number.isNaN(recording.x[cell] ?? Number.NaN);
  const end = recording.ends[ego];
  const ended = end !== undefined && step >= end.step && (
    <>
      <dt>Ended</dt>
      <dd>
        {end.end.replaceAll("_", " ")} at {fixed(end.step * recording.stepLength, 2)} s
      </dd>
    </>
  );
  // Who is not there has no values; an ego that has ended stands where it is.
  if (absent)
    return (
      <dl className="facts ego-facts">
        {ended || (
          <>
            <dt>State</dt>
            <dd className="quiet">not in the run at this time</dd>
          </>
        )}
      </dl>
    );
  return (
    <dl className="facts ego-facts">
      {ended}
      <dt>Speed</dt>
      <dd>
        {number(speed, 2, "m/s")}
        {speed !== undefined && !Number.isNaN(speed) && (
          <span className="quiet"> {fixed(speed * 3.6, 0)} km/h</span>
        )}
      </dd>
      <dt>Acceleration</dt>
      <dd>{number(recording.acceleration[cell], 2, "m/s²")}</dd>
      {!ended && (
        <>
          <dt title="What the agent asks for">Asked</dt>
          <dd>{number(recording.askedAcceleration[own], 2, "m/s²")}</dd>
          <dt title="Angle of the front wheels, positive to the left">Steering</dt>
          <dd>{number((recording.steer[own] ?? Number.NaN) * DEGREES, 1, "°")}</dd>
        </>
      )}
      {!(ended && Number.isNaN(recording.routeS[own])) && (
        <>
          <dt>Route</dt>
          <dd>
            {number(recording.routeS[own], 1, "m")}
            <span className="quiet"> of {fixed(recording.routes[ego]?.length, 0)} m</span>
          </dd>
        </>
      )}
      {series?.holds(step) && <Around series={series} step={step} number={number} />}
      {perceived && <SeenCount perceived={perceived} step={step} />}
      {told && <Told values={told.valuesAt(ego, step)} />}
    </dl>
  );
}

/** The numbers that the agent logged by itself. */
function Told({ values }: { readonly values: ReturnType<AgentTold["valuesAt"]> }) {
  if (values.length === 0) return null;
  return (
    <>
      <dt className="part">Logged by the agent</dt>
      {values.map(([name, value]) => (
        <Fragment key={name}>
          <dt>{name}</dt>
          <dd>{Number.isFinite(value) ? Number(value.toPrecision(5)) : "∞"}</dd>
        </Fragment>
      ))}
    </>
  );
}

/** What is around the ego: the nearest actor, the one ahead, the lane and the next signal. */
function Around({
  series,
  step,
  number,
}: {
  readonly series: Series;
  readonly step: number;
  readonly number: (value: number, digits: number, unit: string) => ReactNode;
}) {
  const ttc = series.at("time_to_collision", step);
  const gap = series.at("gap", step);
  const lead = series.at("lead_gap", step);
  const light = series.at("light_distance", step);
  const lane = series.lane(series.at("lane", step));
  const colour = LIGHTS[series.at("light", step)];
  return (
    <>
      <dt title={series.description("time_to_collision")}>TTC</dt>
      <dd>
        {Number.isNaN(ttc) ? <span className="quiet">none within 10 s</span> : `${fixed(ttc, 2)} s`}
        {!Number.isNaN(ttc) && (
          <span className="quiet"> {series.actor(series.at("time_to_collision_actor", step))}</span>
        )}
      </dd>
      <dt title={series.description("gap")}>Nearest</dt>
      <dd>
        {Number.isNaN(gap) ? <span className="quiet">no other actor</span> : number(gap, 1, "m")}
        <span className="quiet"> {series.actor(series.at("gap_actor", step))}</span>
      </dd>
      <dt title={series.description("lead_gap")}>Ahead</dt>
      <dd>
        {Number.isNaN(lead) ? <span className="quiet">no actor</span> : number(lead, 1, "m")}
        <span className="quiet"> {series.actor(series.at("lead_actor", step))}</span>
      </dd>
      <dt>Lane</dt>
      <dd>{lane ? <code>{lane}</code> : <span className="quiet">off all lanes</span>}</dd>
      <dt>Light ahead</dt>
      <dd>
        {light >= 0 ? (
          `${colour || "off"}, ${fixed(light, 1)} m`
        ) : (
          // Missing, or below 0: the front is past its stop line.
          <span className="quiet">none</span>
        )}
      </dd>
    </>
  );
}

function SeenCount({
  perceived,
  step,
}: {
  readonly perceived: PerceivedActors;
  readonly step: number;
}) {
  const [seen, all] = perceived.counts(step);
  const { sensor, privileged } = perceived.head;
  return (
    <>
      <dt>Perceived</dt>
      <dd>
        {seen} of {all}
        <span className="quiet">
          {privileged
            ? " but its agent saw everything"
            : sensor.range === null
              ? " without a limit of range"
              : ` within ${fixed(sensor.range, 0)} m`}
        </span>
      </dd>
    </>
  );
}
