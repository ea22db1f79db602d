import { Axes, type Frame } from "./Axes";
import { boxOf } from "./curves";
import { linear, rounded, ticks } from "./scale";

export interface BoxRow {
  readonly name: string;
  readonly look: string;
  readonly values: readonly number[];
  /** Whether a wider space precedes it. */
  readonly first?: boolean;
}

const ROW_PX = 18;
const BETWEEN_PX = 8;

/** Distributions of repetitions, one a row: every value as a point, quartiles as a box. */
export function BoxPlots({
  label,
  width,
  rows,
  xTitle,
  names = 260,
}: {
  readonly label: string;
  readonly width: number;
  readonly rows: readonly BoxRow[];
  readonly xTitle: string;
  readonly names?: number;
}) {
  const tops: number[] = [];
  let down = 14;
  for (const [place, { first }] of rows.entries()) {
    if (first && place > 0) down += BETWEEN_PX;
    tops.push(down + ROW_PX / 2);
    down += ROW_PX;
  }
  const height = down + 44;
  const frame: Frame = { left: names, right: width - 20, top: 14, bottom: height - 38 };
  const values = rows.flatMap((row) => row.values);
  const [low, high] = rounded([0, ...values]);
  const toX = linear(low, high, frame.left, frame.right);
  return (
    <svg className="chart" width={width} height={height} role="img" aria-label={label}>
      <Axes
        frame={frame}
        x={{ scale: toX, ticks: ticks(low, high, width / 110), title: xTitle }}
        y={{ scale: () => frame.bottom, ticks: [], title: "" }}
      />
      {rows.map(({ name, look, values }, place) => {
        const box = boxOf(values);
        return (
          <g key={name} className={look} transform={`translate(0,${tops[place] ?? 0})`}>
            <text x={frame.left - 10} textAnchor="end" dy="0.32em">
              {name}
            </text>
            {box ? (
              <>
                <line className="whisker" x1={toX(box.low)} x2={toX(box.high)} />
                <rect
                  className="box"
                  x={toX(box.q1)}
                  width={Math.max(toX(box.q3) - toX(box.q1), 1)}
                  y="-6"
                  height="12"
                />
                <line className="middle" x1={toX(box.median)} x2={toX(box.median)} y1="-7" y2="7" />
                {values.map((value, number) => (
                  // biome-ignore lint/suspicious/noArrayIndexKey: repetitions in their order
                  <circle key={number} className="small-dot" cx={toX(value)} r="2.2" />
                ))}
              </>
            ) : (
              <text className="none" x={frame.left + 6} dy="0.32em">
                not measurable
              </text>
            )}
          </g>
        );
      })}
    </svg>
  );
}
