import { useMemo } from "react";
import { fixed } from "../../components/numbers";
import type { Clock } from "./clock";
import { type LawCurve, robustnessAt } from "./lawCurves";
import { type Line, Plot } from "./Plot";
import type { Range } from "./timeScale";
import { useStep } from "./useMoment";
import { oracleName } from "./verdictWords";

const MOST = 4;

/** The robustness of violated traffic laws over time. */
export function LawPlots({
  curves,
  clock,
  range,
  onRange,
}: {
  readonly curves: readonly LawCurve[];
  readonly clock: Clock;
  readonly range: Range;
  readonly onRange: (range: Range) => void;
}) {
  return curves
    .slice(0, MOST)
    .map((curve) => (
      <LawPlot key={curve.oracle} curve={curve} clock={clock} range={range} onRange={onRange} />
    ));
}

function LawPlot({
  curve,
  clock,
  range,
  onRange,
}: {
  readonly curve: LawCurve;
  readonly clock: Clock;
  readonly range: Range;
  readonly onRange: (range: Range) => void;
}) {
  const step = useStep(clock);
  const here = robustnessAt(curve, step * clock.stepLength);
  const lines = useMemo(
    (): readonly Line[] => [
      { name: "robustness", values: curve.robustness, colour: "violation" },
      { name: "violated below", values: curve.time.map(() => 0), colour: "ink-3", dash: [5, 4] },
    ],
    [curve],
  );
  const title = `${oracleName(curve.oracle)}: robustness`;
  return (
    <section className="panel plot-panel">
      <header title={curve.formula}>
        <h3>{title}</h3>
        <span className="value">
          <i style={{ color: "var(--violation)" }} />
          violated below 0 <b>{here === undefined ? "none" : fixed(here, 2)}</b>
        </span>
      </header>
      <Plot
        label={title}
        time={curve.time}
        lines={lines}
        clock={clock}
        range={range}
        onRange={onRange}
      />
    </section>
  );
}
