import { useSearch } from "@tanstack/react-router";
import { firstOf } from "../../address";
import type { Schemas } from "../../api/client";
import { Choice } from "../../components/Choice";
import { Empty, Loading, Refused } from "../../components/States";
import { useComparison, useStudyBands } from "./asked";
import { Boxes } from "./Boxes";
import { axesOf, type Cell, canCompare } from "./cells";
import { Effects } from "./Effects";
import { Growth, Survival } from "./Growth";
import { MEASURES, measureOf } from "./measures";
import { Overview } from "./Overview";

/** The figures of a study: growth, survival, effect sizes and repetitions. */
export function Figures({
  study,
  cells,
  finished,
  place,
}: {
  readonly study: Schemas["Study"];
  readonly cells: ReadonlyMap<string, Cell>;
  readonly finished: number;
  readonly place: string;
}) {
  const search = useSearch({ from: "/studies/$id" });
  const { agents, methods } = axesOf(cells);
  const measure = measureOf(firstOf(search, "measure"));
  const by = firstOf(search, "by") === "agent" && agents.length > 1 ? "agent" : "method";
  const method = firstOf(search, "baseline_method");
  const agent = firstOf(search, "baseline_agent");
  const isComparable = canCompare(cells, { method, agent });
  const bands = useStudyBands(study.id, finished);
  const comparison = useComparison(
    study.id,
    {
      ...(method ? { baseline_method: method } : {}),
      ...(agent ? { baseline_agent: agent } : {}),
    },
    finished,
    isComparable,
  );
  const campaigns = [...cells.values()].flatMap((cell) => cell.campaigns);
  const simulations = new Map(campaigns.map(({ id, simulations }) => [id, simulations]));
  const places = [
    ...new Set([...cells.values()].map(({ scenario, agent }) => JSON.stringify([scenario, agent]))),
  ];
  const everywhere = place === "all";
  const shown = (bands.data?.bands ?? []).filter(
    ({ scenario, agent }) => everywhere || JSON.stringify([scenario, agent]) === place,
  );
  if (finished === 0)
    return (
      <Empty title="No campaign has finished yet">
        <p>Curves and comparisons are made of finished campaigns.</p>
      </Empty>
    );
  return (
    <>
      <section className="panel">
        <header>
          <h2>By simulations</h2>
          <Choice
            name="place"
            title="Scenario and ADS"
            value={place}
            search={search}
            options={[
              ...places.map((value) => ({ value, text: placeText(value) })),
              { value: "all", text: "all together" },
            ]}
          />
        </header>
        <div className="inside two">
          {bands.isError ? (
            <Refused error={bands.error} />
          ) : bands.isPending ? (
            <Loading />
          ) : (
            <>
              <Survival
                bands={shown}
                methods={methods}
                simulations={simulations}
                file={`${study.id}-survival`}
              />
              {everywhere ? (
                <p className="quiet">Choose one scenario and ADS to see how its failures grow.</p>
              ) : (
                <Growth bands={shown} methods={methods} file={`${study.id}-growth`} />
              )}
            </>
          )}
        </div>
      </section>
      <section className="panel">
        <header>
          <h2>Compared</h2>
          <Choice
            name="measure"
            title="By"
            value={measure.name}
            search={search}
            options={MEASURES.map(({ name, title }) => ({ value: name, text: title }))}
          />
          {agents.length > 1 && (
            <Choice
              name="by"
              title="What"
              value={by}
              search={search}
              options={[
                { value: "method", text: "methods" },
                { value: "agent", text: "ADSs" },
              ]}
            />
          )}
          <Choice
            name={by === "method" ? "baseline_method" : "baseline_agent"}
            title="Against"
            value={
              by === "method"
                ? (comparison.data?.baseline_method ?? "")
                : (comparison.data?.baseline_agent ?? "")
            }
            search={search}
            options={(by === "method" ? methods : agents).map((name) => ({
              value: name,
              text: name,
            }))}
          />
        </header>
        <div className="inside stack">
          {!isComparable ? (
            <p className="quiet">
              Two finished repetitions of two methods, or of two ADSs, on one scenario are needed.
            </p>
          ) : comparison.isError ? (
            <Refused error={comparison.error} />
          ) : comparison.isPending ? (
            <Loading />
          ) : (
            <>
              <Overview
                rows={comparison.data.overview.filter(
                  (row) => row.by === by && row.measure === measure.name,
                )}
              />
              {comparison.data.notes.map((note) => (
                <p key={note} className="quiet">
                  {note}
                </p>
              ))}
              <Effects
                differences={(by === "method"
                  ? comparison.data.by_method
                  : comparison.data.by_agent
                ).filter((one) => one.measure === measure.name)}
                names={by === "method" ? methods : agents}
                title={
                  by === "method" ? "Methods against the baseline" : "ADSs against the baseline"
                }
                file={`${study.id}-effects`}
              />
              <Boxes
                repetitions={comparison.data.campaigns.map((figures) => ({
                  method: figures.method,
                  place: `${figures.scenario}, ${figures.agent}`,
                  campaign: figures.campaign,
                  value: measure.value(figures),
                }))}
                methods={methods}
                measure={measure}
                file={`${study.id}-repetitions`}
              />
            </>
          )}
        </div>
      </section>
    </>
  );
}

function placeText(place: string): string {
  const [scenario, agent] = JSON.parse(place) as readonly [string, string];
  return `${scenario}, ${agent}`;
}
