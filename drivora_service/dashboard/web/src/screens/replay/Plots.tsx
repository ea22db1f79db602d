import { useMemo } from "react";
import { fixed } from "../../components/numbers";
import type { Clock } from "./clock";
import type { Difference } from "./difference";
import { LawPlots } from "./LawPlots";
import type { LawCurve } from "./lawCurves";
import { type Line, Plot } from "./Plot";
import { absentWords, hasValues, type PlotLine, plotGroups } from "./plotGroups";
import type { Range } from "./timeScale";
import { useStep } from "./useMoment";
import type { Series } from "./useSeries";
import "./plots.css";

/** The ego's values over time; the numbers above are those at the cursor. */
export function Plots({
  series,
  clock,
  ego,
  agent,
  range,
  onRange,
  difference,
  laws,
}: {
  readonly series: Series;
  readonly clock: Clock;
  readonly ego: number;
  /** Name of the agent that drives the ego. */
  readonly agent: string;
  readonly range: Range;
  readonly onRange: (range: Range) => void;
  readonly difference: Difference | undefined;
  readonly laws: readonly LawCurve[];
}) {
  const step = useStep(clock);
  const { groups, absent } = useMemo(() => {
    const all = plotGroups(ego, agent);
    const isDrawn = (group: (typeof all)[number]) =>
      hasValues(group, (name) => series.column(name));
    return {
      groups: all.filter(isDrawn).map((group) => ({
        ...group,
        drawn: group.lines.map((line): Line => {
          const values = series.column(line.column);
          return { ...line, values: line.negative ? values.map((value) => -value) : values };
        }),
      })),
      absent: absentWords(all.filter((group) => !isDrawn(group))),
    };
  }, [series, ego, agent]);
  return (
    <>
      <div className="plots whole-width">
        {groups.map(({ title, lines, drawn, left, right }) => (
          <section key={title} className="panel plot-panel">
            <header>
              <h3>{title}</h3>
              {lines
                .filter(({ negative }) => !negative)
                .map((line) => (
                  <Value key={line.name} line={line} series={series} step={step} />
                ))}
            </header>
            <Plot
              label={title}
              time={series.time}
              lines={drawn}
              clock={clock}
              range={range}
              onRange={onRange}
              {...(left ? { left } : {})}
              {...(right ? { right } : {})}
            />
          </section>
        ))}
        <LawPlots curves={laws} clock={clock} range={range} onRange={onRange} />
        {difference && (
          <DifferencePlot
            difference={difference}
            clock={clock}
            ego={ego}
            range={range}
            onRange={onRange}
          />
        )}
      </div>
      {absent && <p className="quiet absent whole-width">{absent}</p>}
    </>
  );
}

/** How far the egos of two runs are apart, and their difference of speed. */
function DifferencePlot({
  difference,
  clock,
  ego,
  range,
  onRange,
}: {
  readonly difference: Difference;
  readonly clock: Clock;
  readonly ego: number;
  readonly range: Range;
  readonly onRange: (range: Range) => void;
}) {
  const step = useStep(clock);
  const time = useMemo(
    () => Float64Array.from(difference.apart, (_, k) => k * clock.stepLength),
    [difference, clock],
  );
  const lines = useMemo(
    (): readonly Line[] => [
      { name: "apart", values: difference.apart, colour: `ego-${ego % 6}` },
      { name: "speed", values: difference.speed, colour: "ink-3", dash: [5, 4], right: true },
    ],
    [difference, ego],
  );
  const value = (values: Float64Array) => {
    const here = values[step];
    return here === undefined || Number.isNaN(here) ? "none" : fixed(here, 2);
  };
  return (
    <section className="panel plot-panel">
      <header>
        <h3>Difference</h3>
        <span className="value">
          <i style={{ color: `var(--ego-${ego % 6})` }} />
          apart (m) <b>{value(difference.apart)}</b>
        </span>
        <span className="value">
          <i style={{ color: "var(--ink-3)" }} data-dashed />
          speed (m/s) <b>{value(difference.speed)}</b>
        </span>
      </header>
      <Plot
        label="Difference of the two runs"
        time={time}
        lines={lines}
        clock={clock}
        range={range}
        onRange={onRange}
      />
    </section>
  );
}

function Value({
  line,
  series,
  step,
}: {
  readonly line: PlotLine;
  readonly series: Series;
  readonly step: number;
}) {
  const value = series.at(line.column, step);
  return (
    <span className="value" title={series.description(line.column)}>
      <i style={{ color: `var(--${line.colour})` }} data-dashed={line.dash !== undefined} />
      {line.name} <b>{Number.isNaN(value) ? "none" : fixed(value, line.digits)}</b>
    </span>
  );
}
