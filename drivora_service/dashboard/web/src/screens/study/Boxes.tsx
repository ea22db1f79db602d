import { BoxPlots } from "../../components/charts/BoxPlots";
import { Figure } from "../../components/charts/Figure";
import { lookOf, type Measure } from "./measures";

export interface Repetition {
  readonly method: string;
  readonly place: string;
  readonly campaign: string;
  readonly value: number | null;
}

/** The repetitions of each method at each place as box plots. */
export function Boxes({
  repetitions,
  methods,
  measure,
  file,
}: {
  readonly repetitions: readonly Repetition[];
  readonly methods: readonly string[];
  readonly measure: Measure;
  readonly file: string;
}) {
  const places = [...new Set(repetitions.map(({ place }) => place))];
  const rows = places.flatMap((place) =>
    methods.flatMap((method, order) => {
      const found = repetitions.filter((one) => one.place === place && one.method === method);
      if (found.length === 0) return [];
      return [
        {
          name: `${method} · ${place}`,
          look: lookOf(methods, method),
          first: order === 0,
          values: found.flatMap(({ value }) => (value === null ? [] : [value])),
        },
      ];
    }),
  );
  const missing = repetitions.filter(({ value }) => value === null).length;
  return (
    <Figure
      title={`Repetitions: ${measure.title}`}
      note={
        missing > 0
          ? `Each point is a campaign. ${missing} of ${repetitions.length} campaigns have no value: none found, or not measurable.`
          : "Each point is a campaign; the box holds the middle half, the line is the median."
      }
      file={file}
      numbers={{
        columns: ["method", "place", "campaign", measure.title],
        rows: repetitions.map(({ method, place, campaign, value }) => [
          method,
          place,
          campaign,
          value,
        ]),
      }}
    >
      {(width) => (
        <BoxPlots
          label={`${measure.title} by method and place`}
          width={width}
          rows={rows}
          xTitle={measure.title}
        />
      )}
    </Figure>
  );
}
