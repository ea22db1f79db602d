import { controlFor } from "../../components/fields/controls";
import { fieldId, Problems } from "../../components/fields/Field";
import { type Definitions, lookOf, propertiesOf } from "../../components/fields/jsonSchema";
import { isObject, type Json, problemsAt, valueAt } from "../../components/fields/pointers";
import { type Editing, problemsOf } from "./editing";
import type { ListName } from "./scenario";

interface Columns {
  readonly document: string;
  readonly names: readonly string[];
}

const STANDING: Columns = { document: "LocationDocument", names: ["x", "y", "yaw"] };
const COLUMNS: Readonly<Record<ListName, Columns>> = {
  ego_vehicles: { document: "WaypointDocument", names: ["x", "y", "yaw"] },
  npc_vehicles: { document: "NpcWaypointDocument", names: ["x", "y", "yaw", "speed", "wait"] },
  npc_walkers: { document: "WalkerWaypointDocument", names: ["x", "y", "speed"] },
  npc_obstacles: STANDING,
  friction_patches: STANDING,
};

/** The places of an actor in numbers, one a row. */
export function RouteTable({
  editing,
  actor,
  list,
  chosen,
  definitions,
  onPlace,
  onRemove,
}: {
  readonly editing: Editing;
  readonly actor: string;
  readonly list: ListName;
  readonly chosen: string;
  readonly definitions: Definitions;
  readonly onPlace: (pointer: string) => void;
  readonly onRemove: (pointer: string) => void;
}) {
  const { document, names } = COLUMNS[list];
  const properties = propertiesOf(definitions[document], definitions);
  const location = valueAt(editing.scenario, `${actor}/location`);
  const route = valueAt(editing.scenario, `${actor}/route`);
  const rows: readonly (readonly [string, Json])[] = isObject(location)
    ? [[`${actor}/location`, location]]
    : (Array.isArray(route) ? (route as readonly Json[]) : []).map(
        (place, index) => [`${actor}/route/${index}`, place] as const,
      );
  const whole = problemsAt(editing.problems, `${actor}/route`);
  return (
    <div className="author-route">
      <h3>{isObject(location) ? "Place" : "Route"}</h3>
      <Problems problems={whole} />
      <table>
        <thead>
          <tr>
            <th scope="col">#</th>
            {names.map((name) => (
              <th key={name} scope="col" title={properties[name]?.description}>
                {name} <span className="quiet">({unitOf(properties[name], definitions)})</span>
              </th>
            ))}
            <th scope="col">
              <span className="hidden-visually">Remove</span>
            </th>
          </tr>
        </thead>
        <tbody>
          {rows.map(([pointer, place], index) => (
            <tr
              key={pointer}
              data-chosen={pointer === chosen}
              onFocus={() => pointer !== chosen && onPlace(pointer)}
            >
              <td>{index}</td>
              {names.map((name) => (
                <td key={name}>
                  <Cell
                    editing={editing}
                    pointer={`${pointer}/${name}`}
                    label={`${name} of place ${index}`}
                    value={isObject(place) ? place[name] : undefined}
                    schema={properties[name]}
                    definitions={definitions}
                  />
                </td>
              ))}
              <td>
                {rows.length > 1 && (
                  <button
                    type="button"
                    className="plain quiet"
                    aria-label={`Remove place ${index}`}
                    title="Remove this place"
                    onClick={() => onRemove(pointer)}
                  >
                    ✕
                  </button>
                )}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
      {rows.map(([pointer], index) => {
        const problems = problemsOf(editing)(pointer);
        return problems.length === 0 ? null : (
          <div key={pointer}>
            <span className="quiet">Place {index}: </span>
            <Problems problems={problems} />
          </div>
        );
      })}
    </div>
  );
}

function unitOf(schema: object | undefined, definitions: Definitions): string {
  if (!schema) return "";
  const { look } = lookOf(schema, definitions);
  return look.kind === "number" ? look.unit : "";
}

function Cell({
  editing,
  pointer,
  label,
  value,
  schema,
  definitions,
}: {
  readonly editing: Editing;
  readonly pointer: string;
  readonly label: string;
  readonly value: Json | undefined;
  readonly schema: object | undefined;
  readonly definitions: Definitions;
}) {
  if (!schema) return null;
  const { look, isNullable } = lookOf(schema, definitions);
  const Control = controlFor(look);
  const id = fieldId(pointer);
  return (
    <>
      <label className="hidden-visually" htmlFor={id}>
        {label}
      </label>
      <Control
        id={id}
        value={value ?? null}
        isNullable={isNullable}
        isInvalid={problemsOf(editing)(pointer).length > 0}
        describedBy=""
        onChange={(next) => editing.set(pointer, next)}
        look={look}
      />
    </>
  );
}
