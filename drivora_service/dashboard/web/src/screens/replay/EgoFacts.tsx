import { fixed } from "../../components/numbers";
import type { Clock } from "./clock";
import type { Recording } from "./recording";
import { useStep } from "./useMoment";

const DEGREES = 180 / Math.PI;

/** The ego's state and what its agent asks for, at the time. */
export function EgoFacts({
  recording,
  clock,
  ego,
}: {
  readonly recording: Recording;
  readonly clock: Clock;
  readonly ego: number;
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
  const end = recording.ends[ego];
  return (
    <dl className="facts ego-facts">
      <dt>Speed</dt>
      <dd>
        {number(speed, 2, "m/s")}
        {speed !== undefined && !Number.isNaN(speed) && (
          <span className="quiet"> {fixed(speed * 3.6, 0)} km/h</span>
        )}
      </dd>
      <dt>Acceleration</dt>
      <dd>{number(recording.acceleration[cell], 2, "m/s²")}</dd>
      <dt title="What the agent asks for">Asked</dt>
      <dd>{number(recording.askedAcceleration[own], 2, "m/s²")}</dd>
      <dt title="Angle of the front wheels, positive to the left">Steering</dt>
      <dd>{number((recording.steer[own] ?? Number.NaN) * DEGREES, 1, "°")}</dd>
      <dt>Route</dt>
      <dd>
        {number(recording.routeS[own], 1, "m")}
        <span className="quiet"> of {fixed(recording.routes[ego]?.length, 0)} m</span>
      </dd>
      {end && step >= end.step && (
        <>
          <dt>Ended</dt>
          <dd>
            {end.end.replaceAll("_", " ")} at {fixed(end.step * recording.stepLength, 2)} s
          </dd>
        </>
      )}
    </dl>
  );
}
