import type { Schemas } from "../../api/client";
import { Fields, Problems } from "../../components/fields/Field";
import { type Definitions, propertiesOf } from "../../components/fields/jsonSchema";
import { isObject, problemsAt, valueAt } from "../../components/fields/pointers";
import { fixed } from "../../components/numbers";
import { AgentChoice } from "./AgentChoice";
import { type Editing, problemsOf } from "./editing";
import { ModelChoice } from "./ModelChoice";
import { RouteTable } from "./RouteTable";
import { type ListName, listNameOf, NOUNS } from "./scenario";
import type { ShownActor } from "./shownActors";
import { hasRoute } from "./tool";

const DOCUMENTS: Readonly<Record<ListName, string>> = {
  ego_vehicles: "EgoDocument",
  npc_vehicles: "NpcVehicleDocument",
  npc_walkers: "NpcWalkerDocument",
  npc_obstacles: "NpcObstacleDocument",
  friction_patches: "FrictionPatchDocument",
};
/** The properties that have a field of the plain kind, in their order. */
const PLAIN: Readonly<Record<ListName, readonly string[]>> = {
  ego_vehicles: ["id", "start_time", "initial_speed", "dynamics"],
  npc_vehicles: [
    "id",
    "start_time",
    "behavior",
    "at_end",
    "deceleration",
    "lateral_acceleration",
    "joins",
  ],
  npc_walkers: ["id", "start_time", "joins"],
  npc_obstacles: ["id", "length", "width", "start_time"],
  friction_patches: ["id", "friction", "length", "width"],
};

/** The properties of one actor or patch. */
export function ActorProperties({
  editing,
  pointer,
  place,
  shown,
  definitions,
  models,
  agents,
  onPlace,
  onRemove,
  onCopy,
  onExtend,
  onClose,
}: {
  readonly editing: Editing;
  readonly pointer: string;
  /** Pointer to the chosen place; "" for none. */
  readonly place: string;
  readonly shown: ShownActor | undefined;
  readonly definitions: Definitions;
  readonly models: readonly Schemas["Model"][];
  readonly agents: readonly Schemas["Agent"][];
  readonly onPlace: (pointer: string) => void;
  readonly onRemove: (pointer: string) => void;
  readonly onCopy: () => void;
  readonly onExtend: () => void;
  readonly onClose: () => void;
}) {
  const list = listNameOf(pointer);
  const actor = valueAt(editing.scenario, pointer);
  if (!list || !isObject(actor)) return null;
  const properties = propertiesOf(definitions[DOCUMENTS[list]], definitions);
  const own = problemsAt(editing.problems, pointer);
  return (
    <section className="panel author-part" aria-label="Properties of the actor">
      <header>
        <h2>
          {titleOf(list)} <code>{String(actor.id ?? "")}</code>
        </h2>
        <button type="button" className="plain quiet" onClick={onClose} title="Close (escape)">
          ✕<span className="hidden-visually">Close</span>
        </button>
      </header>
      <div className="inside">
        <p className="row-of-buttons">
          {hasRoute(list) && (
            <button type="button" onClick={onExtend} title="Click more places on the map (r)">
              Extend route
            </button>
          )}
          <button type="button" onClick={onCopy} title="Another of the same (d)">
            Duplicate
          </button>
          <button type="button" onClick={() => onRemove(pointer)} title="Remove it (delete)">
            Remove
          </button>
        </p>
        <Problems problems={own} />
        {shown && shown.pathLength > 0 && (
          <p className="quiet">Its way is {fixed(shown.pathLength, 0)} m long.</p>
        )}
        {list !== "friction_patches" && (
          <ModelChoice editing={editing} pointer={`${pointer}/model`} list={list} models={models} />
        )}
        {list === "ego_vehicles" && (
          <AgentChoice editing={editing} pointer={pointer} agents={agents} />
        )}
        <Fields
          pointer={pointer}
          properties={properties}
          names={PLAIN[list]}
          definitions={definitions}
          value={actor}
          problemsOf={problemsOf(editing)}
          onChange={editing.set}
        />
        <RouteTable
          editing={editing}
          actor={pointer}
          list={list}
          chosen={place}
          definitions={definitions}
          onPlace={onPlace}
          onRemove={onRemove}
        />
      </div>
    </section>
  );
}

function titleOf(list: ListName): string {
  const noun = NOUNS[list];
  return noun.charAt(0).toUpperCase() + noun.slice(1);
}
