import type { Schemas } from "../../api/client";
import { isObject, type JsonObject, valueAt } from "../../components/fields/pointers";
import { flat, lengthOf } from "../../roads/lines";
import { type Plane, toMap, yawToMap } from "./plane";
import { actorOf, actorsOf, type DraftActor, type ListName } from "./scenario";

/** An actor or a patch as the map shows it, in the plane of the network. */
export interface ShownActor {
  readonly pointer: string;
  readonly list: ListName;
  /** Number in its list, which gives an ego its colour. */
  readonly row: number;
  readonly id: string;
  readonly x: number;
  readonly y: number;
  /** Radians. */
  readonly yaw: number;
  readonly length: number;
  readonly width: number;
  readonly places: readonly {
    readonly pointer: string;
    readonly x: number;
    readonly y: number;
  }[];
  /** The way that it will take, x and y in turn; empty where there is none. */
  readonly path: readonly number[];
  readonly pathLength: number;
  /** Friction coefficient of a patch. */
  readonly friction: number | undefined;
  readonly hasProblem: boolean;
}

const SIZES: Readonly<Record<ListName, readonly [number, number]>> = {
  ego_vehicles: [4.8, 2],
  npc_vehicles: [4.8, 2],
  npc_walkers: [0.4, 0.4],
  npc_obstacles: [1.5, 1.5],
  friction_patches: [20, 8],
};

export type Models = ReadonlyMap<string, Pick<Schemas["Model"], "length" | "width">>;

/** Returns the key of a model in a list of the document: its name alone may be of two kinds. */
export function modelKey(list: ListName, model: string): string {
  const kind = { npc_walkers: "walker", npc_obstacles: "obstacle" }[list as string] ?? "vehicle";
  return `${kind} ${model}`;
}

/** Returns the actors of a scenario; what the service knows of them may be a little older. */
export function shownActors(
  scenario: JsonObject,
  plane: Plane,
  models: Models,
  inspected: Schemas["Inspection"] | undefined,
): readonly ShownActor[] {
  const known = new Map(inspected?.actors.map((actor) => [actor.pointer, actor]));
  const wrong = new Set(inspected?.problems.map(({ pointer }) => actorOf(pointer)));
  return actorsOf(scenario).flatMap((actor) => {
    const found = known.get(actor.pointer);
    const shown = shownActor(
      scenario,
      actor,
      plane,
      models,
      found?.id === actor.id ? found : undefined,
    );
    return shown ? [{ ...shown, hasProblem: wrong.has(actor.pointer) }] : [];
  });
}

function shownActor(
  scenario: JsonObject,
  actor: DraftActor,
  plane: Plane,
  models: Models,
  found: Schemas["InspectedActor"] | undefined,
): ShownActor | undefined {
  const places = actor.places.map((place) => {
    const [x, y] = toMap(plane, place);
    return { pointer: place.pointer, x, y };
  });
  const [start, next] = places;
  const [first] = actor.places;
  if (!start || !first) return undefined;
  const model = models.get(modelKey(actor.list, actor.model));
  const [length, width] = SIZES[actor.list];
  const heading = next ? Math.atan2(next.y - start.y, next.x - start.x) : 0;
  const item = valueAt(scenario, actor.pointer);
  const friction = isObject(item) ? item.friction : undefined;
  return {
    pointer: actor.pointer,
    list: actor.list,
    row: Number(actor.pointer.slice(actor.pointer.lastIndexOf("/") + 1)),
    id: actor.id,
    x: start.x,
    y: start.y,
    yaw: first.yaw === undefined ? (found?.yaw ?? heading) : yawToMap(plane, first.yaw),
    length: actor.length ?? model?.length ?? found?.length ?? length,
    width: actor.width ?? model?.width ?? found?.width ?? width,
    places,
    path: found ? flat(found.path) : [],
    pathLength: found?.path_length ?? 0,
    friction: typeof friction === "number" ? friction : undefined,
    hasProblem: false,
  };
}

const DETOUR_FACTOR = 2;
const DETOUR_M = 100;

/** Returns whether the way of an actor is much longer than the lines between its places. */
export function takesDetour({ places, pathLength }: ShownActor): boolean {
  const line = lengthOf(places.flatMap(({ x, y }) => [x, y]));
  return pathLength > Math.max(DETOUR_FACTOR * line, line + DETOUR_M);
}

/** Returns the actor whose box is at a place of the map, or is nearest within some metres. */
export function actorNear(
  actors: readonly ShownActor[],
  x: number,
  y: number,
  within: number,
): ShownActor | undefined {
  let best: ShownActor | undefined;
  let bestDistance = Number.POSITIVE_INFINITY;
  for (const actor of actors) {
    const cos = Math.cos(actor.yaw);
    const sin = Math.sin(actor.yaw);
    const along = Math.abs((x - actor.x) * cos + (y - actor.y) * sin) - actor.length / 2;
    const across = Math.abs((y - actor.y) * cos - (x - actor.x) * sin) - actor.width / 2;
    const distance = Math.hypot(Math.max(along, 0), Math.max(across, 0));
    // A patch lies under what stands on it.
    const rank = distance + (actor.list === "friction_patches" ? within / 2 : 0);
    if (distance <= within && rank < bestDistance) {
      best = actor;
      bestDistance = rank;
    }
  }
  return best;
}
