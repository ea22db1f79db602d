import { type PointerEvent, useState } from "react";
import { Axes, type Frame } from "./Axes";
import { bandPath, type Points, stepPath, valueAt } from "./curves";
import { linear, rounded, spread, ticks, tickText, wholeTicks } from "./scale";

export interface Curve extends Points {
  readonly name: string;
  /** Class of its look: `bad`, `other`, or `series-0` to `series-5`. */
  readonly look: string;
}

export interface CurveBand {
  readonly name: string;
  readonly look: string;
  readonly x: readonly number[];
  readonly low: readonly number[];
  readonly median: readonly number[];
  readonly high: readonly number[];
}

export interface CurvesProps {
  readonly label: string;
  readonly width: number;
  readonly height?: number;
  readonly curves: readonly Curve[];
  readonly bands?: readonly CurveBand[];
  readonly xTitle: string;
  readonly yTitle: string;
  /** The end of x; without it that of the longest curve. */
  readonly xEnd?: number;
  /** Shares are drawn from 0 to 1, and counts with whole ticks. */
  readonly share?: boolean;
  /** Room for the names at the ends of the curves. */
  readonly names?: number;
}

const LABEL_PX = 14;

/** Step curves with bands, each named at its end; the pointer reads their values. */
export function Curves(props: CurvesProps) {
  const { width, curves, bands = [], share = false } = props;
  const height = props.height ?? 260;
  const frame: Frame = {
    left: 42,
    right: width - (props.names ?? 130),
    top: 26,
    bottom: height - 38,
  };
  const [pointed, setPointed] = useState<number>();
  const end = props.xEnd ?? Math.max(1, ...[...curves, ...bands].map(({ x }) => x.at(-1) ?? 0));
  const tops = [...curves.flatMap(({ y }) => y), ...bands.flatMap(({ high }) => high)];
  const top = share ? 1 : Math.max(rounded([0, ...tops])[1], 1);
  const toX = linear(0, end, frame.left, frame.right);
  const toY = linear(0, top, frame.bottom, frame.top);
  const lines = [
    ...bands.map(({ name, look, x, median }) => ({ name, look, x, y: median })),
    ...curves,
  ];
  const text = (value: number) =>
    share ? `${Math.round(value * 100)} %` : tickText(Math.round(value * 100) / 100);
  const wishes = lines.map(({ y }) => toY(y.at(-1) ?? 0));
  const ends = lines.map(({ x }) => Math.min(toX(x.at(-1) ?? 0), frame.right));
  const places = placesOf(wishes, ends, frame);
  const point = (event: PointerEvent<SVGRectElement>) => {
    const box = event.currentTarget.getBoundingClientRect();
    setPointed(Math.round(((event.clientX - box.left) / box.width) * end));
  };
  return (
    <svg className="chart" width={width} height={height} role="img" aria-label={props.label}>
      <Axes
        frame={frame}
        x={{ scale: toX, ticks: wholeTicks(0, end, width / 110), title: props.xTitle }}
        y={{
          scale: toY,
          ticks: share ? ticks(0, 1, 4) : wholeTicks(0, top, 5),
          title: props.yTitle,
          text: share ? text : tickText,
        }}
      />
      {bands.map(({ name, look, x, low, high }) => (
        <path key={name} className={`band ${look}`} d={bandPath(x, low, high, toX, toY)} />
      ))}
      {lines.map((line, place) => (
        <path
          key={line.name}
          className={`curve ${line.look} ${place < bands.length ? "median" : ""}`}
          d={stepPath(line, toX, toY)}
        />
      ))}
      {lines.map(({ name, look, y }, place) => {
        const right = ends[place] ?? frame.right;
        return (
          <g key={name} className={`name ${look}`}>
            <path
              className="leader"
              d={`M${right + 2},${wishes[place] ?? 0}L${right + 8},${places[place] ?? 0}`}
            />
            <text x={right + 12} y={places[place]} dy="0.32em">
              {name} {pointed === undefined ? text(y.at(-1) ?? 0) : ""}
            </text>
          </g>
        );
      })}
      {pointed !== undefined && (
        <g className="pointed" data-passing>
          <line x1={toX(pointed)} x2={toX(pointed)} y1={frame.top} y2={frame.bottom} />
          <text x={toX(pointed)} y={frame.top - 10} textAnchor="middle">
            {tickText(pointed)}
          </text>
          {lines.map((line, place) => {
            const value = valueAt(line, pointed);
            if (value === undefined) return null;
            return (
              <g key={line.name} className={`name ${line.look}`}>
                <circle cx={toX(pointed)} cy={toY(value)} r="3" />
                <text x={width - 4} y={places[place]} dy="0.32em" textAnchor="end">
                  {text(value)}
                </text>
              </g>
            );
          })}
        </g>
      )}
      <rect
        className="sensor"
        x={frame.left}
        y={frame.top}
        width={Math.max(frame.right - frame.left, 0)}
        height={frame.bottom - frame.top}
        onPointerMove={point}
        onPointerLeave={() => setPointed(undefined)}
      />
    </svg>
  );
}

/** Returns the heights of names: those of curves that end at the same x do not overlap. */
function placesOf(
  wishes: readonly number[],
  ends: readonly number[],
  { top, bottom }: Frame,
): readonly number[] {
  const placed = [...wishes];
  for (const end of new Set(ends)) {
    const members = ends.flatMap((other, place) => (other === end ? [place] : []));
    const heights = spread(
      members.map((place) => wishes[place] ?? 0),
      LABEL_PX,
      top,
      bottom,
    );
    members.forEach((place, order) => {
      placed[place] = heights[order] ?? 0;
    });
  }
  return placed;
}
