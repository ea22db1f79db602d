import type { ReactNode } from "react";
import { Fields, fieldId, Problems } from "../../components/fields/Field";
import { type Definitions, propertiesOf } from "../../components/fields/jsonSchema";
import {
  below,
  isObject,
  type JsonObject,
  problemsAt,
  valueAt,
} from "../../components/fields/pointers";
import { type Editing, problemsOf } from "./editing";
import { townOf } from "./scenario";

/** What is true of the whole scenario: its network, weather, lights, traffic and times. */
export function ScenarioProperties({
  editing,
  definitions,
  networks,
  lights,
}: {
  readonly editing: Editing;
  readonly definitions: Definitions;
  readonly networks: readonly string[];
  /** Ids of the network's traffic lights. */
  readonly lights: readonly string[];
}) {
  const { scenario } = editing;
  const town = townOf(scenario);
  const problems = problemsOf(editing)("/map_region/town");
  const part = (name: string, pointer: string, title: string, names?: readonly string[]) => (
    <Part title={title} isOpen={isObject(valueAt(scenario, pointer))} key={pointer}>
      <Group
        editing={editing}
        definitions={definitions}
        document={name}
        pointer={pointer}
        {...(names ? { names } : {})}
      />
    </Part>
  );
  return (
    <section className="panel author-part" aria-label="Properties of the scenario">
      <header>
        <h2>Scenario</h2>
      </header>
      <div className="inside">
        <div className="field" data-kind="choice">
          <label htmlFor={fieldId("/map_region/town")}>Network</label>
          <span className="control">
            <select
              id={fieldId("/map_region/town")}
              value={town}
              aria-invalid={problems.length > 0}
              onChange={({ target }) => editing.set("/map_region/town", target.value)}
            >
              {!networks.includes(town) && <option value={town}>{town || "none"}</option>}
              {networks.map((name) => (
                <option key={name}>{name}</option>
              ))}
            </select>
          </span>
          <div className="about">
            <Problems problems={problems} />
          </div>
        </div>
        <Fields
          pointer=""
          properties={propertiesOf(definitions.ScenarioDocument, definitions)}
          names={["seed", "max_sim_time", "stuck_after", "step_length"]}
          definitions={definitions}
          value={scenario}
          problemsOf={problemsOf(editing)}
          onChange={editing.set}
        />
        {part("WeatherDocument", "/weather", "Weather")}
        {part("TrafficLightsDocument", "/traffic_lights", "Times of all traffic lights", [
          "green_time",
          "yellow_time",
          "red_time",
          "offset",
        ])}
        {lights.length > 0 && (
          <Part
            title={`Times of single lights (${lights.length})`}
            isOpen={isObject(valueAt(scenario, "/traffic_lights/junctions"))}
          >
            {lights.map((light) =>
              part("LightTimesDocument", below("/traffic_lights/junctions", light), light),
            )}
          </Part>
        )}
        {part("BackgroundTrafficDocument", "/background_traffic", "Background traffic")}
        {part("RegionDocument", "/map_region/region_segment", "Region that all places lie in")}
        <p className="quiet">
          Changes of the weather during the run, the frame and extensions are written in the text.
        </p>
      </div>
    </section>
  );
}

function Part({
  title,
  isOpen,
  children,
}: {
  readonly title: string;
  readonly isOpen: boolean;
  readonly children: ReactNode;
}) {
  return (
    <details className="author-more" open={isOpen}>
      <summary>{title}</summary>
      {children}
    </details>
  );
}

function Group({
  editing,
  definitions,
  document,
  pointer,
  names,
}: {
  readonly editing: Editing;
  readonly definitions: Definitions;
  readonly document: string;
  readonly pointer: string;
  readonly names?: readonly string[];
}) {
  const value = valueAt(editing.scenario, pointer);
  const known: JsonObject = isObject(value) ? value : {};
  return (
    <>
      <Problems problems={problemsAt(editing.problems, pointer)} />
      <Fields
        pointer={pointer}
        properties={propertiesOf(definitions[document], definitions)}
        {...(names ? { names } : {})}
        definitions={definitions}
        value={known}
        problemsOf={problemsOf(editing)}
        onChange={editing.set}
      />
    </>
  );
}
