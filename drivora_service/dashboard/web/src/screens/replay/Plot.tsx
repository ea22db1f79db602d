import { useEffect, useRef } from "react";
import "./validLanguage";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { useTheme } from "../../shell/theme";
import type { Clock } from "./clock";
import { type Range, valueTicks } from "./timeScale";

export interface Line {
  readonly name: string;
  readonly values: Float64Array;
  /** Name of a token of the theme. */
  readonly colour: string;
  readonly dash?: readonly number[];
  readonly right?: boolean;
}

export interface PlotProps {
  readonly label: string;
  readonly time: Float64Array;
  readonly lines: readonly Line[];
  /** Bounds of the left and the right axis; without them, those of the values. */
  readonly left?: readonly [number, number];
  readonly right?: readonly [number, number];
  readonly clock: Clock;
  readonly range: Range;
  readonly onRange: (range: Range) => void;
}

const HEIGHT = 112;
const AXIS = 34;
/** Labelled values of an axis, about. */
const MOST_TICKS = 4;

/** Values over the time of a run: a click goes to a time, dragging comes nearer. */
export function Plot({ label, time, lines, left, right, clock, range, onRange }: PlotProps) {
  const frame = useRef<HTMLDivElement>(null);
  const made = useRef<{ plot: uPlot; show: () => void }>(undefined);
  const latest = useRef({ range, onRange });
  latest.current = { range, onRange };
  const theme = useTheme();

  // biome-ignore lint/correctness/useExhaustiveDependencies: colours are read anew with each theme
  useEffect(() => {
    const element = frame.current;
    if (!element) return;
    const style = getComputedStyle(document.documentElement);
    const token = (name: string) => style.getPropertyValue(`--${name}`).trim();
    const axis = {
      stroke: token("ink-3"),
      font: "11px system-ui, sans-serif",
      grid: { stroke: token("line"), width: 1 },
      ticks: { show: false },
    };
    const marker = document.createElement("div");
    marker.className = "plot-cursor";
    const two = lines.some((line) => line.right);
    const plot = new uPlot(
      {
        width: element.clientWidth,
        height: HEIGHT,
        legend: { show: false },
        padding: [6, two ? 0 : 10, 0, 0],
        cursor: { y: false, points: { show: false }, drag: { x: true, y: false, setScale: false } },
        scales: {
          x: { time: false, range: () => [latest.current.range.from, latest.current.range.to] },
          y: bounds(left),
          ...(two ? { z: bounds(right) } : {}),
        },
        axes: [
          { ...axis, size: 20, gap: 2 },
          { ...axis, size: AXIS, gap: 3, splits: valuesOf },
          ...(two
            ? [
                {
                  ...axis,
                  scale: "z",
                  side: 1 as const,
                  size: AXIS,
                  gap: 3,
                  splits: valuesOf,
                  grid: { show: false },
                },
              ]
            : []),
        ],
        series: [
          {},
          ...lines.map((line) => ({
            label: line.name,
            stroke: token(line.colour),
            width: 1.5,
            scale: line.right ? "z" : "y",
            points: { show: false },
            ...(line.dash ? { dash: [...line.dash] } : {}),
          })),
        ],
        hooks: {
          setSelect: [
            (self) => {
              if (self.select.width < 4) return;
              const from = self.posToVal(self.select.left, "x");
              const to = self.posToVal(self.select.left + self.select.width, "x");
              self.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
              latest.current.onRange({ from, to });
            },
          ],
        },
      },
      [time, ...lines.map((line) => gaps(line.values))] as uPlot.AlignedData,
      element,
    );
    plot.over.append(marker);
    plot.over.addEventListener("click", (event) => {
      clock.pause();
      clock.seek(plot.posToVal(event.offsetX, "x"));
    });
    const show = () => {
      const { from, to } = latest.current.range;
      marker.hidden = clock.time < from || clock.time > to;
      marker.style.transform = `translateX(${plot.valToPos(clock.time, "x")}px)`;
    };
    show();
    const stop = clock.listen(show);
    const watcher = new ResizeObserver(() => {
      plot.setSize({ width: element.clientWidth, height: HEIGHT });
      show();
    });
    watcher.observe(element);
    made.current = { plot, show };
    return () => {
      stop();
      watcher.disconnect();
      plot.destroy();
      made.current = undefined;
    };
  }, [time, lines, left, right, clock, theme]);

  useEffect(() => {
    const now = made.current;
    if (!now) return;
    now.plot.setScale("x", { min: range.from, max: range.to });
    now.show();
  }, [range]);

  return <div ref={frame} className="plot" role="img" aria-label={label} />;
}

function bounds(fixed: readonly [number, number] | undefined): uPlot.Scale {
  if (fixed) return { range: [fixed[0], fixed[1]] };
  return {
    range: (_, min, max) => {
      if (min === null || max === null) return [0, 1];
      const margin = Math.max(0.08 * (max - min), 0.5);
      return [min >= 0 ? 0 : min - margin, max + margin];
    },
  };
}

/** Returns the labelled values of an axis. */
function valuesOf(_: uPlot, __: number, low: number, high: number): number[] {
  return [...valueTicks(low, high, MOST_TICKS)];
}

/** Returns values with gaps where they are missing. */
function gaps(values: Float64Array): (number | null)[] {
  return Array.from(values, (value) => (Number.isNaN(value) ? null : value));
}
