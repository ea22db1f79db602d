import type { Schemas } from "../../api/client";

type Verdict = Schemas["Verdict"];

/** The robustness of a traffic law over an ego's part: negative where it is violated. */
export interface LawCurve {
  readonly oracle: string;
  readonly formula: string;
  readonly time: Float64Array;
  readonly robustness: Float64Array;
}

/** The curves in the verdicts on an ego: one for each violated law, the most violated first. */
export function lawCurves(verdicts: readonly Verdict[], ego: string): readonly LawCurve[] {
  const found = new Map<string, LawCurve>();
  for (const { oracle, ego: judged, evidence } of verdicts) {
    const time = numbers(evidence?.curve_times);
    const robustness = numbers(evidence?.curve_robustness);
    if (judged !== ego || found.has(oracle) || !time || time.length !== robustness?.length)
      continue;
    const formula = typeof evidence?.formula === "string" ? evidence.formula : "";
    found.set(oracle, { oracle, formula, time, robustness });
  }
  return [...found.values()].sort((a, b) => least(a) - least(b));
}

/** The robustness at a time: that of the last point before it. */
export function robustnessAt({ time, robustness }: LawCurve, seconds: number): number | undefined {
  let place = -1;
  while (place + 1 < time.length && (time[place + 1] ?? 0) <= seconds + 1e-9) place += 1;
  return robustness[place];
}

function least({ robustness }: LawCurve): number {
  return Math.min(...robustness);
}

function numbers(value: unknown): Float64Array | undefined {
  if (!Array.isArray(value) || !value.length) return undefined;
  return value.every((one) => typeof one === "number") ? Float64Array.from(value) : undefined;
}
