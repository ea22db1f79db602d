export interface SignedInterval {
  readonly name: string;
  /** Difference and its interval, larger to the right; undefined ends: there is no interval. */
  readonly value: number;
  readonly low: number | undefined;
  readonly high: number | undefined;
  readonly look: string;
  /** What it says in words. */
  readonly words: string;
}

const ROW_PX = 22;
const TOP_PX = 24;

/** Returns the greatest distance from zero in a row, to which it is scaled; 0 without any. */
export function reachOf({ value, low, high }: SignedInterval): number {
  return Math.max(Math.abs(value), Math.abs(low ?? 0), Math.abs(high ?? 0));
}

/** Differences of several units with their 95 % intervals: one a row, each on a scale of its own. */
export function SignedIntervals({
  label,
  width,
  rows,
  left,
  right,
  names = 230,
}: {
  readonly label: string;
  readonly width: number;
  readonly rows: readonly SignedInterval[];
  /** What the left of the middle means. */
  readonly left: string;
  readonly right: string;
  readonly names?: number;
}) {
  const height = TOP_PX + rows.length * ROW_PX + 6;
  const words = Math.min(360, width * 0.36);
  const from = names;
  const to = Math.max(width - words, from + 80);
  const middle = (from + to) / 2;
  const half = (to - from) / 2 - 8;
  return (
    <svg className="chart" width={width} height={height} role="img" aria-label={label}>
      <text className="title" x={middle - 8} y="12" textAnchor="end">
        ← {left}
      </text>
      <text className="title" x={middle + 8} y="12">
        {right} →
      </text>
      <line className="reference" x1={middle} x2={middle} y1={TOP_PX - 4} y2={height - 6} />
      {rows.map((row, place) => {
        const reach = reachOf(row);
        const at = (value: number) => middle + (reach > 0 ? (value / reach) * half : 0);
        const { name, value, low, high, look } = row;
        return (
          <g
            key={name}
            className={look}
            transform={`translate(0,${TOP_PX + (place + 0.5) * ROW_PX})`}
          >
            <text x={from - 10} textAnchor="end" dy="0.32em">
              {name}
            </text>
            {low !== undefined && high !== undefined && (
              <>
                <line className="whisker" x1={at(low)} x2={at(high)} />
                <path className="whisker" d={`M${at(low)},-4v8M${at(high)},-4v8`} />
              </>
            )}
            <circle className="dot" cx={at(value)} r="4" />
            <text x={to + 12} dy="0.32em">
              {row.words}
            </text>
          </g>
        );
      })}
    </svg>
  );
}
