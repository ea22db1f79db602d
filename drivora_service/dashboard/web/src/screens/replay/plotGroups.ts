import type { Line } from "./Plot";

/** A line of a plot, by the column of the series that it draws. */
export interface PlotLine extends Omit<Line, "values"> {
  readonly column: string;
  readonly digits: number;
  readonly negative?: boolean;
}

export interface PlotGroup {
  readonly title: string;
  readonly lines: readonly PlotLine[];
  readonly left?: readonly [number, number];
  readonly right?: readonly [number, number];
  /** Why there may be no value, in words. */
  readonly absent: string;
}

const TTC_MOST = 10;

/** Returns what is drawn of an ego that an agent drives, a plot each. */
export function plotGroups(ego: number, agent: string): readonly PlotGroup[] {
  const own = `ego-${ego % 6}`;
  const absent = "the ego was not in the run";
  return [
    {
      title: "Speed (m/s)",
      absent,
      lines: [
        { name: "speed", column: "speed", colour: own, digits: 2 },
        { name: "limit", column: "speed_limit", colour: "ink-3", dash: [5, 4], digits: 2 },
      ],
    },
    {
      title: "Acceleration (m/s²)",
      absent,
      lines: [
        { name: "along", column: "acceleration", colour: own, digits: 2 },
        { name: "asked", column: "commanded_acceleration", colour: "ink", dash: [2, 2], digits: 2 },
        { name: "grip", column: "available_grip", colour: "ink-3", dash: [5, 4], digits: 1 },
        {
          name: "−grip",
          column: "available_grip",
          colour: "ink-3",
          dash: [5, 4],
          digits: 1,
          negative: true,
        },
      ],
    },
    {
      title: "TTC (s), gap (m)",
      absent: "there was no other actor",
      left: [0, TTC_MOST],
      lines: [
        { name: "TTC", column: "time_to_collision", colour: "violation", digits: 2 },
        { name: "gap", column: "gap", colour: own, dash: [5, 4], right: true, digits: 1 },
      ],
    },
    {
      title: "Controls (0–1, rad)",
      absent: `${agent} drives without throttle, brake and steering`,
      left: [0, 1],
      lines: [
        { name: "throttle", column: "throttle", colour: "good", digits: 2 },
        { name: "brake", column: "brake", colour: "violation", digits: 2 },
        { name: "steer", column: "steer", colour: own, dash: [5, 4], right: true, digits: 3 },
      ],
    },
  ];
}

/** Whether a plot would show anything: a line of it has a value. */
export function hasValues(
  group: Pick<PlotGroup, "lines">,
  column: (name: string) => Float64Array,
): boolean {
  return group.lines.some((line) => column(line.column).some((value) => !Number.isNaN(value)));
}

/** Returns why plots are left out, as a sentence; empty if none is. */
export function absentWords(groups: readonly PlotGroup[]): string {
  const parts = groups.map(
    ({ title, absent }) => `${title.replaceAll(/ \([^)]*\)/g, "")}, as ${absent}`,
  );
  return parts.length === 0 ? "" : `Not drawn: ${parts.join("; ")}.`;
}
