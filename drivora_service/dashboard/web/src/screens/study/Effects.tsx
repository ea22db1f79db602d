import type { Schemas } from "../../api/client";
import type { Numbers } from "../../components/charts/export";
import { Figure } from "../../components/charts/Figure";
import { Intervals } from "../../components/charts/Intervals";
import { lookOf } from "./measures";

/** Effect sizes of methods or ADSs against a baseline, with their intervals. */
export function Effects({
  differences,
  names,
  title,
  file,
}: {
  readonly differences: readonly Schemas["Difference"][];
  /** All methods or ADSs, in the order of their looks. */
  readonly names: readonly string[];
  readonly title: string;
  readonly file: string;
}) {
  const first = differences[0];
  if (!first) return null;
  const rows = differences.map(({ scenario, method, a12, low, high, judgement }) => ({
    name: `${method} · ${scenario}`,
    value: a12,
    low,
    high,
    judgement,
    look: lookOf(names, method),
  }));
  return (
    <Figure
      title={title}
      note={`Probability (A12) that a repetition has ${first.larger_is_better ? "more" : "fewer"} ${first.title} than one of ${first.baseline}; bars: 95 % confidence; p: Mann-Whitney U, two-sided, corrected by Holm.`}
      file={file}
      numbers={numbersOf(differences)}
    >
      {(width) => (
        <Intervals
          label={title}
          width={width}
          rows={rows}
          xTitle={`← worse than ${first.baseline} · A12 · better →`}
        />
      )}
    </Figure>
  );
}

function numbersOf(differences: readonly Schemas["Difference"][]): Numbers {
  return {
    columns: [
      "name",
      "place",
      "baseline",
      "measure",
      "median",
      "baseline median",
      "A12",
      "low",
      "high",
      "p",
      "p (Holm)",
      "repetitions",
      "judgement",
    ],
    rows: differences.map((one) => [
      one.method,
      one.scenario,
      one.baseline,
      one.measure,
      one.median,
      one.baseline_median,
      one.a12,
      one.low,
      one.high,
      one.p,
      one.p_holm,
      one.repetitions,
      one.judgement,
    ]),
  };
}
