import type { Schemas } from "../../api/client";
import type { Numbers } from "../../components/charts/export";
import { Figure } from "../../components/charts/Figure";
import { SignedIntervals } from "../../components/charts/SignedIntervals";
import { differences } from "./paired";

type Metric = Schemas["MetricComparison"];

/** The paired differences of metrics: first those that can be better, then those that describe. */
export function Metrics({ metrics }: { readonly metrics: readonly Metric[] }) {
  const directed = differences(metrics, true);
  const describing = differences(metrics, false);
  const equal = metrics.filter(({ difference }) => difference === 0).length;
  const unknown = metrics.filter(({ difference }) => difference === null).length;
  if (metrics.length === 0) return null;
  return (
    <section className="panel">
      <div className="inside stack">
        {directed.length > 0 && (
          <Figure
            level={2}
            title="Metrics"
            note="Means over scenarios of A and B, and the mean of the paired differences with its 95 % interval; each row has its own scale. B is undecided unless p, by the test of flipped signs, corrected by Holm, is below 0.05."
            file="metrics"
            numbers={numbersOf(metrics)}
          >
            {(width) => (
              <SignedIntervals
                label="Paired differences of metrics"
                width={width}
                rows={directed}
                left="B is worse"
                right="B is better"
              />
            )}
          </Figure>
        )}
        {describing.length > 0 && (
          <Figure
            title="Metrics that describe a run"
            file="describing-metrics"
            numbers={numbersOf(metrics.filter(({ better }) => better === "neither"))}
          >
            {(width) => (
              <SignedIntervals
                label="Paired differences of metrics that describe a run"
                width={width}
                rows={describing}
                left="B is lower"
                right="B is higher"
              />
            )}
          </Figure>
        )}
        <p className="quiet">
          Metrics that are equal in the mean: {equal} · not measurable in any pair: {unknown}
        </p>
      </div>
    </section>
  );
}

function numbersOf(metrics: readonly Metric[]): Numbers {
  return {
    columns: [
      "metric",
      "unit",
      "better",
      "mean of A",
      "mean of B",
      "difference",
      "low",
      "high",
      "p",
      "p (Holm)",
      "B is",
      "scenarios",
      "pairs",
      "not measurable",
    ],
    rows: metrics.map((one) => [
      one.metric,
      one.unit,
      one.better,
      one.mean_a,
      one.mean_b,
      one.difference,
      one.low,
      one.high,
      one.p,
      one.p_holm,
      one.judgement,
      one.scenarios,
      one.pairs,
      one.not_measurable,
    ]),
  };
}
