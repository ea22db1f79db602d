import {
  below,
  isObject,
  type Json,
  type JsonObject,
  keysOf,
  valueAt,
  withValue,
} from "../../components/fields/pointers";

/** The lists of a scenario that have actors, and its patches. */
export const LISTS = [
  "ego_vehicles",
  "npc_vehicles",
  "npc_walkers",
  "npc_obstacles",
  "friction_patches",
] as const;
export type ListName = (typeof LISTS)[number];

/** What is added, in words. */
export const NOUNS: Readonly<Record<ListName, string>> = {
  ego_vehicles: "ego",
  npc_vehicles: "vehicle",
  npc_walkers: "walker",
  npc_obstacles: "obstacle",
  friction_patches: "patch",
};

/** A place of an actor as the document has it. */
export interface DraftPlace {
  readonly pointer: string;
  readonly x: number;
  readonly y: number;
  /** Degrees. */
  readonly yaw: number | undefined;
}

/** An actor or a patch as the document has it, as far as it is well-formed. */
export interface DraftActor {
  readonly pointer: string;
  readonly list: ListName;
  readonly id: string;
  readonly model: string;
  readonly places: readonly DraftPlace[];
  /** Metres; undefined if the document leaves it to the model. */
  readonly length: number | undefined;
  readonly width: number | undefined;
}

const MODELS: Readonly<Record<Exclude<ListName, "friction_patches">, string>> = {
  ego_vehicles: "vehicle.lincoln.mkz_2020",
  npc_vehicles: "vehicle.audi.a2",
  npc_walkers: "walker.pedestrian.0001",
  npc_obstacles: "static.prop.container",
};

/** Returns a scenario without actors. */
export function emptyScenario(town: string): JsonObject {
  return { version: "1.0", frame: "sumo", map_region: { town }, ego_vehicles: [] };
}

export function townOf(scenario: JsonObject): string {
  const town = valueAt(scenario, "/map_region/town");
  return typeof town === "string" ? town : "";
}

/** Returns all actors and patches; of malformed ones what is well-formed. */
export function actorsOf(scenario: JsonObject): readonly DraftActor[] {
  return LISTS.flatMap((list) =>
    listOf(scenario, list).flatMap((item, index) => {
      const pointer = `/${list}/${index}`;
      return isObject(item) ? [actorAt(item, list, pointer)] : [];
    }),
  );
}

function actorAt(item: JsonObject, list: ListName, pointer: string): DraftActor {
  const standing = list === "npc_obstacles" || list === "friction_patches";
  const places = standing ? [item.location] : Array.isArray(item.route) ? item.route : [];
  const base = standing ? `${pointer}/location` : `${pointer}/route`;
  return {
    pointer,
    list,
    id: typeof item.id === "string" ? item.id : "",
    model: typeof item.model === "string" ? item.model : "",
    places: places.flatMap((place: Json | undefined, index: number) =>
      isObject(place) && typeof place.x === "number" && typeof place.y === "number"
        ? [
            {
              pointer: standing ? base : below(base, index),
              x: place.x,
              y: place.y,
              yaw: typeof place.yaw === "number" ? place.yaw : undefined,
            },
          ]
        : [],
    ),
    length: typeof item.length === "number" ? item.length : undefined,
    width: typeof item.width === "number" ? item.width : undefined,
  };
}

function listOf(scenario: JsonObject, list: ListName): readonly Json[] {
  const items = scenario[list];
  return Array.isArray(items) ? items : [];
}

/** Returns the pointer to the actor that a place of the document is in; "" for none. */
export function actorOf(pointer: string): string {
  const [list, index] = keysOf(pointer);
  return LISTS.some((one) => one === list) && index !== undefined ? `/${list}/${index}` : "";
}

export function listNameOf(pointer: string): ListName | undefined {
  return LISTS.find((list) => list === keysOf(pointer)[0]);
}

/** Returns the list that a place of the document is, if it is one without actors. */
export function noActorYet(scenario: JsonObject, pointer: string): ListName | undefined {
  const list = listNameOf(pointer);
  return list && pointer === `/${list}` && listOf(scenario, list).length === 0 ? list : undefined;
}

/** A place to be written, in the document's frame. */
export interface NewPlace {
  readonly x: number;
  readonly y: number;
  readonly yaw?: number;
}

/** Returns the scenario with a new actor at a place, and the pointer to it. */
export function withActor(
  scenario: JsonObject,
  list: ListName,
  places: readonly NewPlace[],
): readonly [JsonObject, string] {
  const items = listOf(scenario, list);
  const actor: JsonObject = { id: freeId(scenario, NOUNS[list]), ...partsOf(list, places) };
  const changed = { ...scenario, [list]: [...items, actor] };
  return [changed, `/${list}/${items.length}`];
}

function partsOf(list: ListName, places: readonly NewPlace[]): JsonObject {
  const all = places.map((place) => ({ ...place }));
  const [first = { x: 0, y: 0 }] = all;
  switch (list) {
    case "friction_patches":
      return { location: first, length: 20, width: 8, friction: 0.3 };
    case "npc_obstacles":
      return { model: MODELS[list], location: first };
    case "ego_vehicles":
      return { model: MODELS[list], route: all, agent: { name: "idm" } };
    default:
      return { model: MODELS[list], route: all };
  }
}

function freeId(scenario: JsonObject, noun: string): string {
  const taken = new Set(actorsOf(scenario).map(({ id }) => id));
  if (!taken.has(noun)) return noun;
  let number = 2;
  while (taken.has(`${noun}-${number}`)) number++;
  return `${noun}-${number}`;
}

/** Returns the scenario with one more waypoint at the end of an actor's route. */
export function withWaypoint(scenario: JsonObject, actor: string, place: NewPlace): JsonObject {
  return withWaypointAt(scenario, actor, place, Number.POSITIVE_INFINITY);
}

/** Returns the scenario with one more waypoint in an actor's route before another. */
export function withWaypointAt(
  scenario: JsonObject,
  actor: string,
  place: NewPlace,
  index: number,
): JsonObject {
  const route = valueAt(scenario, `${actor}/route`);
  const places: readonly Json[] = Array.isArray(route) ? route : [];
  return withValue(scenario, `${actor}/route`, places.toSpliced(index, 0, { ...place }));
}

/** Returns the scenario with a place moved; it has a heading if it had one. */
export function withPlaceMoved(
  scenario: JsonObject,
  pointer: string,
  { x, y, yaw }: NewPlace,
): JsonObject {
  const before = valueAt(scenario, pointer);
  const kept = isObject(before) ? before : {};
  const heading = "yaw" in kept && yaw !== undefined ? { yaw } : {};
  return withValue(scenario, pointer, { ...kept, x, y, ...heading });
}

/** Returns the scenario without an actor, or without a waypoint. */
export function without(scenario: JsonObject, pointer: string): JsonObject {
  const [list, index, , place] = keysOf(pointer);
  const changed = withValue(scenario, pointer, undefined);
  if (list === undefined || index === undefined) return changed;
  // A route without places, and a list without actors, are left out as a whole.
  if (place !== undefined) {
    const route = valueAt(changed, `/${list}/${index}/route`);
    if (Array.isArray(route) && route.length === 0) return without(scenario, `/${list}/${index}`);
    return changed;
  }
  const rest = changed[list];
  if (list !== "ego_vehicles" && Array.isArray(rest) && rest.length === 0)
    return withValue(changed, `/${list}`, undefined);
  return changed;
}

/** Returns the scenario with another of the same, and the pointer to it. */
export function withCopy(scenario: JsonObject, pointer: string): readonly [JsonObject, string] {
  const list = listNameOf(pointer);
  const item = valueAt(scenario, pointer);
  if (!list || !isObject(item)) return [scenario, pointer];
  const items = listOf(scenario, list);
  const copy = { ...item, id: freeId(scenario, NOUNS[list]) };
  return [{ ...scenario, [list]: [...items, copy] }, `/${list}/${items.length}`];
}
