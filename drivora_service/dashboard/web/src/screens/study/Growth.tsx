import type { Schemas } from "../../api/client";
import { Curves } from "../../components/charts/Curves";
import { survival } from "../../components/charts/curves";
import { Figure } from "../../components/charts/Figure";
import { lookOf } from "./measures";

type Bands = Schemas["MethodBands"];

/** Failures that count against simulations by method: median and quartiles of the repetitions. */
export function Growth({
  bands,
  methods,
  file,
}: {
  readonly bands: readonly Bands[];
  readonly methods: readonly string[];
  readonly file: string;
}) {
  return (
    <Figure
      title="Failures that count against simulations"
      note="Dashed: median of the repetitions; band: their quartiles."
      file={file}
      numbers={{
        columns: ["method", "simulations", "low", "median", "high"],
        rows: bands.flatMap(({ method, at, avoidable: { low, median, high } }) =>
          at.map((x, place) => [
            method,
            x,
            low[place] ?? null,
            median[place] ?? null,
            high[place] ?? null,
          ]),
        ),
      }}
    >
      {(width) => (
        <Curves
          label="Failures that count against simulations by method"
          width={width}
          curves={[]}
          bands={bands.map(({ method, at, avoidable }) => ({
            name: method,
            look: lookOf(methods, method),
            x: at,
            ...avoidable,
          }))}
          xTitle="simulations"
          yTitle="simulations with a failure that counts"
        />
      )}
    </Figure>
  );
}

/** The share of repetitions that have found no failure that counts yet. */
export function Survival({
  bands,
  methods,
  simulations,
  file,
}: {
  readonly bands: readonly Bands[];
  readonly methods: readonly string[];
  /** Simulations by campaign. */
  readonly simulations: ReadonlyMap<string, number>;
  readonly file: string;
}) {
  const curves = methods.flatMap((method) => {
    const repetitions = bands
      .filter((one) => one.method === method)
      .flatMap(({ campaigns, first_avoidable, at }) =>
        campaigns.map((id, place) => ({
          event: first_avoidable[place] ?? null,
          until: simulations.get(id) ?? at.at(-1) ?? 0,
        })),
      );
    if (repetitions.length === 0) return [];
    return [{ name: method, look: lookOf(methods, method), ...survival(repetitions) }];
  });
  return (
    <Figure
      title="Repetitions without a failure that counts"
      note="Share that has found none after so many simulations (Kaplan–Meier): the lower, the sooner a method finds one."
      file={file}
      numbers={{
        columns: ["method", "simulations", "share without"],
        rows: curves.flatMap(({ name, x, y }) =>
          x.map((at, place) => [name, at, y[place] ?? null]),
        ),
      }}
    >
      {(width) => (
        <Curves
          label="Share of repetitions without a failure that counts, by method"
          width={width}
          curves={curves}
          xTitle="simulations"
          yTitle="share of repetitions"
          share
        />
      )}
    </Figure>
  );
}
