import { useQuery } from "@tanstack/react-query";
import { api, body } from "../api/client";
import { plain } from "../screens/failures/words";
import { Help } from "./Help";

const BETTER = { higher: "Higher is better.", lower: "Lower is better." } as const;

/** Reads the descriptions of metrics and objectives; they do not change while the service runs. */
export function useMeasures() {
  return useQuery({
    queryKey: ["measures"],
    queryFn: async () => body(await api.GET("/api/v1/metrics:describe")),
  });
}

/** The name of a metric or an objective; a click shows its definition, unit and source. */
export function MeasureHelp({
  name,
  feedback = "",
}: {
  readonly name: string;
  /** The feedback that measures it, where several have an objective of this name. */
  readonly feedback?: string;
}) {
  const { data } = useMeasures();
  const found = data?.items.filter((one) => one.name === name) ?? [];
  const measure = found.find((one) => one.feedback === feedback) ?? found[0];
  if (!measure) return <>{plain(name)}</>;
  const better = measure.better && measure.better in BETTER;
  return (
    <Help name={plain(name)}>
      <h3>
        {plain(name)} {measure.unit && <span className="quiet">in {measure.unit}</span>}
      </h3>
      <p>{measure.definition}</p>
      {better && <p>{BETTER[measure.better as keyof typeof BETTER]}</p>}
      {measure.threshold && <p>Threshold: {measure.threshold}</p>}
      {measure.source && <p className="quiet">{measure.source}</p>}
    </Help>
  );
}
