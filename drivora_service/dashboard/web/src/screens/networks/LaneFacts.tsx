import { Link } from "@tanstack/react-router";
import { Copy } from "../../components/Copy";
import { fixed } from "../../components/numbers";
import type { LanePlace } from "../../roads/laneIndex";

/** What is known of a lane and of the place that was clicked on it. */
export function LaneFacts({
  place: { lane, offset, lateral },
  x,
  y,
  light,
  network,
}: {
  readonly place: LanePlace;
  readonly x: number;
  readonly y: number;
  readonly light: string;
  readonly network: string;
}) {
  const area = lane.kind === "walking_area";
  const position = area
    ? `${lane.id} at x ${fixed(x, 2)}, y ${fixed(y, 2)}`
    : `${lane.id} at ${fixed(offset, 2)} m, lateral ${fixed(lateral, 2)} m, x ${fixed(x, 2)}, y ${fixed(y, 2)}`;
  return (
    <section className="panel" aria-label="Lane">
      <header>
        <h2>
          <code>{lane.id}</code>
        </h2>
      </header>
      <div className="inside">
        <dl className="facts">
          <dt>Kind</dt>
          <dd>{lane.kind.replace("_", " ")}</dd>
          {lane.street && (
            <>
              <dt>Street</dt>
              <dd>{lane.street}</dd>
            </>
          )}
          <dt>Edge</dt>
          <dd>
            <code>{lane.edge}</code>, lane {lane.index}
          </dd>
          <dt>Width</dt>
          <dd>{fixed(lane.width, 2)} m</dd>
          {lane.drivable && (
            <>
              <dt>Speed limit</dt>
              <dd>
                {fixed(lane.speed_limit, 1)} m/s ({fixed(lane.speed_limit * 3.6, 0)} km/h)
              </dd>
              <dt>Markings</dt>
              <dd>
                left {lane.left_marking}, right {lane.right_marking}
              </dd>
            </>
          )}
          {light && (
            <>
              <dt>Traffic light</dt>
              <dd>
                <Link
                  to="/networks/$name"
                  params={{ name: network }}
                  search={{ "traffic light": light }}
                >
                  {light}
                </Link>
              </dd>
            </>
          )}
          {!area && (
            <>
              <dt>Place</dt>
              <dd>
                {fixed(offset, 2)} m along, {fixed(Math.abs(lateral), 2)} m{" "}
                {lateral >= 0 ? "left" : "right"} of the centre
              </dd>
            </>
          )}
          <dt>Coordinates</dt>
          <dd>
            x {fixed(x, 2)}, y {fixed(y, 2)}
          </dd>
        </dl>
        <p className="row-of-buttons">
          <Copy text={lane.id} label="Copy the lane" />
          <Copy text={position} label="Copy lane, offset and coordinates" />
        </p>
      </div>
    </section>
  );
}
