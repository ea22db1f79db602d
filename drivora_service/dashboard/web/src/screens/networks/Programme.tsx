import type { Schemas } from "../../api/client";
import { fixed } from "../../components/numbers";
import type { LightColour } from "../../roads/palette";
import { colourOf } from "../../roads/signalColour";

type Light = Schemas["TrafficLight"];

const ROW = 16;
const LEFT = 40;
const WIDTH = 300;
const TURNS: Readonly<Record<string, string>> = {
  s: "straight",
  l: "left",
  L: "half left",
  r: "right",
  R: "half right",
  t: "U-turn",
};
/** Heights of the bars: as on the map, the colour is not needed to tell them apart. */
const HEIGHTS: Readonly<Record<LightColour, number>> = { red: 10, yellow: 7, green: 4, off: 2 };

/** A light's programme: one row a signal, one cycle from left to right. */
export function Programme({ light }: { readonly light: Light }) {
  const cycle = light.phases.reduce((sum, phase) => sum + phase.duration, 0);
  const perSecond = (WIDTH - LEFT - 4) / Math.max(cycle, 1);
  const links = [...new Map(light.links.map((link) => [link.index, link])).values()];
  const starts: number[] = [];
  light.phases.reduce((at, phase) => {
    starts.push(at);
    return at + phase.duration;
  }, 0);
  const ways = [...new Set(links.map(({ direction }) => direction))]
    .map((direction) => `${direction} ${TURNS[direction] ?? ""}`)
    .join(", ");
  const height = links.length * ROW + 22;
  return (
    <>
      <p className="quiet">
        Programme {light.program}, cycle of {fixed(cycle, 0)} s
        {light.offset ? `, delayed by ${fixed(light.offset, 0)} s` : ""}. A scenario may set other
        durations.
      </p>
      <p className="quiet">
        A row is a signal with its number and its way: {ways}. Its lanes are in its tooltip.
      </p>
      <svg
        className="programme"
        viewBox={`0 0 ${WIDTH} ${height}`}
        role="img"
        aria-label={`Phases of ${light.id}`}
      >
        {links.map((link, row) => (
          <g key={link.index} transform={`translate(0 ${row * ROW})`}>
            <title>
              {`Signal ${link.index}: ${link.lane} to ${link.to_lane}, ${TURNS[link.direction] ?? link.direction}`}
            </title>
            <text x={LEFT - 6} y={12} textAnchor="end">
              {link.index} {link.direction}
            </text>
            {light.phases.map((phase, place) => {
              const colour = colourOf(phase.state[link.index]);
              return (
                <rect
                  // biome-ignore lint/suspicious/noArrayIndexKey: phases have no other name
                  key={place}
                  x={LEFT + (starts[place] ?? 0) * perSecond}
                  y={ROW / 2 - HEIGHTS[colour] / 2}
                  width={Math.max(phase.duration * perSecond - 0.6, 0.6)}
                  height={HEIGHTS[colour]}
                  fill={`var(--light-${colour})`}
                />
              );
            })}
          </g>
        ))}
        {[0, 0.25, 0.5, 0.75, 1].map((share) => (
          <text
            key={share}
            x={LEFT + share * cycle * perSecond}
            y={height - 6}
            textAnchor={share === 1 ? "end" : "middle"}
          >
            {fixed(share * cycle, 0)}
            {share === 1 ? " s" : ""}
          </text>
        ))}
      </svg>
    </>
  );
}
