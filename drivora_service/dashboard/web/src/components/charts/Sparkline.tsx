import { stepPath } from "./curves";
import { linear } from "./scale";

/** Failures against simulations in one line of a table: those that count, and the others above. */
export function Sparkline({
  at,
  lower,
  upper,
  end,
  label,
}: {
  readonly at: readonly number[];
  readonly lower: readonly number[];
  readonly upper: readonly number[];
  readonly end: number;
  readonly label: string;
}) {
  const toX = linear(0, end, 1, 99);
  const total = lower.map((value, place) => value + (upper[place] ?? 0));
  const toY = linear(0, Math.max(1, ...total), 19, 2);
  const area = (y: readonly number[]) => {
    const last = toX(at.at(-1) ?? 0).toFixed(1);
    return `${stepPath({ x: at, y }, toX, toY)}H${last}V19H1Z`;
  };
  return (
    <svg className="chart spark" width="100" height="20" role="img" aria-label={label}>
      <line className="grid" x1="1" x2="99" y1="19" y2="19" />
      <path className="area other" d={area(total)} />
      <path className="curve other" d={stepPath({ x: at, y: total }, toX, toY)} />
      {lower.some((value) => value > 0) && (
        <>
          <path className="area bad" d={area(lower)} />
          <path className="curve bad" d={stepPath({ x: at, y: lower }, toX, toY)} />
        </>
      )}
    </svg>
  );
}
