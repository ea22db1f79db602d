import { Axes, type Frame } from "./Axes";
import { type Points, stepPath } from "./curves";
import { linear, rounded, ticks } from "./scale";

export interface ScatterPoint {
  readonly id: string;
  readonly x: number;
  readonly y: number;
  readonly look: string;
  readonly title: string;
}

export interface ScatterProps {
  readonly label: string;
  readonly width: number;
  readonly height?: number;
  readonly points: readonly ScatterPoint[];
  /** A line of steps over the points: the best so far, or a Pareto front. */
  readonly line?: Points & { readonly name: string };
  readonly xTitle: string;
  readonly yTitle: string;
  /** Called with the id of a point that is clicked. */
  readonly onOpen?: (id: string) => void;
}

/** Points by two values; different signs tell the looks apart without colours. */
export function Scatter(props: ScatterProps) {
  const { width, points, line, onOpen } = props;
  const height = props.height ?? 320;
  const frame: Frame = { left: 52, right: width - 24, top: 26, bottom: height - 38 };
  const [left, right] = rounded(points.map(({ x }) => x));
  const [low, high] = rounded(points.map(({ y }) => y));
  const toX = linear(left, right, frame.left, frame.right);
  const toY = linear(low, high, frame.bottom, frame.top);
  return (
    // biome-ignore lint/a11y/useKeyWithClickEvents: the list of evaluations opens them by keyboard
    <svg
      className="chart"
      width={width}
      height={height}
      role="img"
      aria-label={props.label}
      onClick={(event) => {
        const mark = event.target instanceof Element && event.target.closest("[data-id]");
        const id = mark ? mark.getAttribute("data-id") : null;
        if (id !== null) onOpen?.(id);
      }}
    >
      <Axes
        frame={frame}
        x={{ scale: toX, ticks: ticks(left, right, width / 110), title: props.xTitle }}
        y={{ scale: toY, ticks: ticks(low, high, 6), title: props.yTitle }}
      />
      {line && line.x.length > 0 && (
        <g className="name line">
          <path className="curve line" d={stepPath(line, toX, toY)} />
          <text x={toX(line.x[0] ?? 0) + 8} y={toY(line.y[0] ?? 0) - 8}>
            {line.name}
          </text>
        </g>
      )}
      {points.map(({ id, x, y, look, title }) => (
        <path
          key={id}
          data-id={id}
          className={`point ${look}`}
          d={SIGNS[look] ?? ROUND}
          transform={`translate(${toX(x).toFixed(1)},${toY(y).toFixed(1)})`}
        >
          <title>{title}</title>
        </path>
      ))}
    </svg>
  );
}

const ROUND = "M-2.6,0a2.6,2.6 0 1 0 5.2,0a2.6,2.6 0 1 0 -5.2,0";
const SIGNS: Readonly<Record<string, string>> = {
  bad: "M-3.6,-3.6L3.6,3.6M-3.6,3.6L3.6,-3.6",
  lost: "M0,-4L4,3H-4Z",
};
