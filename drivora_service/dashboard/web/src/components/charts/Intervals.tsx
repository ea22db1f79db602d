import { Axes, type Frame } from "./Axes";
import { linear } from "./scale";

export interface Interval {
  readonly name: string;
  readonly value: number;
  readonly low: number;
  readonly high: number;
  readonly look: string;
  /** What it says in words. */
  readonly judgement: string;
}

const ROW_PX = 20;
const MIDDLE = 0.5;

/** Probabilities with their 95 % confidence intervals, one a row; ½ means no difference. */
export function Intervals({
  label,
  width,
  rows,
  xTitle,
  names = 260,
}: {
  readonly label: string;
  readonly width: number;
  readonly rows: readonly Interval[];
  readonly xTitle: string;
  readonly names?: number;
}) {
  const height = 64 + rows.length * ROW_PX;
  const words = Math.min(210, width * 0.24);
  const frame: Frame = { left: names, right: width - words, top: 20, bottom: height - 38 };
  const toX = linear(0, 1, frame.left, frame.right);
  return (
    <svg className="chart" width={width} height={height} role="img" aria-label={label}>
      <Axes
        frame={frame}
        x={{ scale: toX, ticks: [0, 0.25, 0.5, 0.75, 1], title: xTitle }}
        y={{ scale: () => frame.bottom, ticks: [], title: "" }}
      />
      <line
        className="reference"
        x1={toX(MIDDLE)}
        x2={toX(MIDDLE)}
        y1={frame.top}
        y2={frame.bottom}
      />
      {rows.map(({ name, value, low, high, look, judgement }, place) => (
        <g
          key={name}
          className={look}
          transform={`translate(0,${frame.top + (place + 0.5) * ROW_PX})`}
        >
          <text x={frame.left - 10} textAnchor="end" dy="0.32em">
            {name}
          </text>
          <line className="whisker" x1={toX(low)} x2={toX(high)} />
          <path className="whisker" d={`M${toX(low)},-4v8M${toX(high)},-4v8`} />
          <circle className="dot" cx={toX(value)} r="4" />
          <text x={frame.right + 12} dy="0.32em">
            {value.toFixed(2)} {judgement}
          </text>
        </g>
      ))}
    </svg>
  );
}
