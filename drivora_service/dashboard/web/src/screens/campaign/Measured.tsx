import { MeasureHelp, useMeasures } from "../../help/MeasureHelp";
import type { Evaluation } from "./evaluation";

/** The measured values of an evaluation: objectives of its search, general scores, metrics. */
export function Measured({ evaluation }: { readonly evaluation: Evaluation }) {
  const { data } = useMeasures();
  const units = new Map(data?.items.map(({ name, unit }) => [name, unit]));
  const groups = [
    ["Objectives", evaluation.objectives],
    ["General objectives", evaluation.scores],
    ["Metrics", evaluation.metrics],
  ] as const;
  return (
    <details className="panel measured">
      <summary>Measured values</summary>
      <div className="inside">
        {groups.map(([title, values]) => (
          <section key={title}>
            <h3>{title}</h3>
            <dl className="values">
              {Object.entries(values).map(([name, value]) => (
                <div key={name}>
                  <dt>
                    <MeasureHelp name={name} />
                  </dt>
                  <dd>
                    {value === null ? (
                      <span className="quiet">not measurable</span>
                    ) : (
                      `${Number(value.toPrecision(5))} ${unitOf(units.get(name))}`
                    )}
                  </dd>
                </div>
              ))}
            </dl>
          </section>
        ))}
      </div>
    </details>
  );
}

/** A number without a unit has the unit 1. */
function unitOf(unit: string | undefined): string {
  return unit === "1" ? "" : (unit ?? "");
}
