import { type Scale, tickText } from "./scale";

/** Where a chart draws: pixels from the left and the top of its SVG. */
export interface Frame {
  readonly left: number;
  readonly right: number;
  readonly top: number;
  readonly bottom: number;
}

export interface AxisProps {
  readonly scale: Scale;
  readonly ticks: readonly number[];
  readonly title: string;
  readonly text?: (value: number) => string;
}

/** Axes with round ticks; lines across at the ticks of y alone. */
export function Axes({
  frame,
  x,
  y,
}: {
  readonly frame: Frame;
  readonly x: AxisProps;
  readonly y: AxisProps;
}) {
  return (
    <g className="axes">
      {y.ticks.map((tick) => (
        <g key={tick} transform={`translate(0,${y.scale(tick)})`}>
          <line className="grid" x1={frame.left} x2={frame.right} />
          <text x={frame.left - 6} textAnchor="end" dy="0.32em">
            {(y.text ?? tickText)(tick)}
          </text>
        </g>
      ))}
      <line className="base" x1={frame.left} x2={frame.right} y1={frame.bottom} y2={frame.bottom} />
      {x.ticks.map((tick) => (
        <g key={tick} transform={`translate(${x.scale(tick)},${frame.bottom})`}>
          <line className="base" y2="4" />
          <text y="16" textAnchor="middle">
            {(x.text ?? tickText)(tick)}
          </text>
        </g>
      ))}
      <text className="title" x={frame.right} y={frame.bottom + 32} textAnchor="end">
        {x.title}
      </text>
      <text className="title" x={frame.left - 34} y={frame.top - 10}>
        {y.title}
      </text>
    </g>
  );
}
