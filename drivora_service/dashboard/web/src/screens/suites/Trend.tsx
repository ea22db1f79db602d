import { Axes, type Frame } from "../../components/charts/Axes";
import { Figure } from "../../components/charts/Figure";
import { linear } from "../../components/charts/scale";
import { moment } from "../../components/numbers";
import type { History, SuiteRun } from "./suite";

const HEIGHT = 190;

interface Point {
  readonly run: SuiteRun;
  readonly mean: number;
  readonly low: number;
  readonly high: number;
}

/** The share of scenarios that pass and the mean score, run by run, with their intervals. */
export function Trend({ history }: { readonly history: History }) {
  const { runs, suite } = history;
  const rates = runs.map((run) => point(run, run.pass_rate, 100));
  const scores = runs.flatMap((run) => (run.score ? [point(run, run.score, 1)] : []));
  return (
    <div className="two">
      <TrendFigure title="Scenarios that pass" suite={suite} unit="%" points={rates} />
      {scores.length > 0 && (
        <TrendFigure title="Driving score" suite={suite} unit="points" points={scores} />
      )}
    </div>
  );
}

function point(
  run: SuiteRun,
  { mean, low, high }: { mean: number; low?: number | null; high?: number | null },
  times: number,
): Point {
  return {
    run,
    mean: times * mean,
    low: times * Math.max(low ?? mean, 0),
    high: Math.min(times * (high ?? mean), 100),
  };
}

function TrendFigure({
  title,
  suite,
  unit,
  points,
}: {
  readonly title: string;
  readonly suite: string;
  readonly unit: string;
  readonly points: readonly Point[];
}) {
  return (
    <Figure
      title={title}
      level={2}
      note="Bars are intervals at 95 %; a cross marks a gate that failed."
      file={`${suite}-${title.toLowerCase().replaceAll(" ", "-")}`}
      numbers={{
        columns: ["run", "at", "gate", unit, "low", "high"],
        rows: points.map(({ run, mean, low, high }) => [
          run.id,
          run.created_at,
          run.fails ? "failed" : "passed",
          mean,
          low,
          high,
        ]),
      }}
    >
      {(width) => <Chart title={title} unit={unit} width={width} points={points} />}
    </Figure>
  );
}

function Chart({
  title,
  unit,
  width,
  points,
}: {
  readonly title: string;
  readonly unit: string;
  readonly width: number;
  readonly points: readonly Point[];
}) {
  const frame: Frame = { left: 44, right: width - 16, top: 24, bottom: HEIGHT - 40 };
  const toX = linear(-0.5, points.length - 0.5, frame.left, frame.right);
  const toY = linear(0, 100, frame.bottom, frame.top);
  const ends = points.length > 1 ? [0, points.length - 1] : [0];
  return (
    <svg className="chart" width={width} height={HEIGHT} role="img" aria-label={title}>
      <Axes
        frame={frame}
        x={{
          scale: toX,
          ticks: ends,
          title: "",
          text: (place) => moment(points[place]?.run.created_at).slice(5, 10),
        }}
        y={{ scale: toY, ticks: [0, 25, 50, 75, 100], title: unit }}
      />
      <path
        className="trend"
        d={points
          .map(({ mean }, place) => `${place ? "L" : "M"}${toX(place)},${toY(mean)}`)
          .join("")}
      />
      {points.map(({ run, mean, low, high }, place) => (
        <g
          key={run.id}
          className={run.fails ? "failed" : "passed"}
          transform={`translate(${toX(place)},0)`}
        >
          <title>{`${moment(run.created_at)}: ${mean.toFixed(0)} ${unit}. ${run.sentence}`}</title>
          <line className="whisker" y1={toY(low)} y2={toY(high)} />
          {run.fails ? (
            <path className="cross" d={`M-4,${toY(mean) - 4}l8,8m0,-8l-8,8`} />
          ) : (
            <circle className="dot" cy={toY(mean)} r="4" />
          )}
        </g>
      ))}
    </svg>
  );
}
