import { Axes, type Frame } from "../../components/charts/Axes";
import { Figure } from "../../components/charts/Figure";
import { linear } from "../../components/charts/scale";
import { type History, labelStride, type RunName, type SuiteRun } from "./suite";

const HEIGHT = 190;

interface Point {
  readonly run: SuiteRun;
  readonly name: RunName | undefined;
  readonly mean: number;
  readonly low: number;
  readonly high: number;
}

/** The share of scenarios that pass and the mean score, run by run, with their intervals. */
export function Trend({
  history,
  names,
}: {
  readonly history: History;
  readonly names: readonly RunName[];
}) {
  const { runs, suite } = history;
  const rates = runs.map((run, place) => point(run, names[place], run.pass_rate, 100));
  const scores = runs.flatMap((run, place) =>
    run.score ? [point(run, names[place], run.score, 1)] : [],
  );
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
  name: RunName | undefined,
  { mean, low, high }: { mean: number; low?: number | null; high?: number | null },
  times: number,
): Point {
  return {
    run,
    name,
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
        columns: ["run", "ADS", "at", "gate", unit, "low", "high"],
        rows: points.map(({ run, name, mean, low, high }) => [
          run.id,
          name?.driver ?? "",
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
  // From the last run back, so that the newest has its label.
  const apart = (frame.right - frame.left) / points.length;
  const stride = labelStride(
    points.map(({ name }) => name?.when ?? ""),
    apart,
  );
  const labelled = points
    .map((_, place) => place)
    .filter((place) => (points.length - 1 - place) % stride === 0);
  const letters = Math.floor((apart * stride - 8) / 7);
  return (
    <svg className="chart" width={width} height={HEIGHT} role="img" aria-label={title}>
      <Axes
        frame={frame}
        x={{
          scale: toX,
          ticks: labelled,
          title: "",
          text: (place) => points[place]?.name?.when ?? "",
        }}
        y={{ scale: toY, ticks: [0, 25, 50, 75, 100], title: unit }}
      />
      <g className="axes">
        {labelled.map((place) => (
          <text
            key={points[place]?.run.id}
            x={toX(place)}
            y={frame.bottom + 31}
            textAnchor="middle"
          >
            {shortened(points[place]?.name?.driver ?? "", letters)}
          </text>
        ))}
      </g>
      <path
        className="trend"
        d={points
          .map(({ mean }, place) => `${place ? "L" : "M"}${toX(place)},${toY(mean)}`)
          .join("")}
      />
      {points.map(({ run, name, mean, low, high }, place) => (
        <g
          key={run.id}
          className={run.fails ? "failed" : "passed"}
          transform={`translate(${toX(place)},0)`}
        >
          <title>{`${name?.whole}: ${mean.toFixed(0)} ${unit}. ${run.sentence}`}</title>
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

function shortened(text: string, letters: number): string {
  return text.length > letters ? `${text.slice(0, Math.max(letters - 1, 1))}…` : text;
}
