import type { JsonObject } from "../../components/fields/pointers";
import { withValue } from "../../components/fields/pointers";
import type { KindPlace } from "./places";
import { actorsOf, type NewPlace, withActor } from "./scenario";

type Write = (place: { x: number; y: number; yaw: number | undefined }) => NewPlace;

/**
 * Returns the scenario in which an ego drives through a place, and the pointer to it.
 *
 * The only ego is sent there; of several, or none, another is added.
 */
export function withDrive(
  scenario: JsonObject,
  { drive }: KindPlace,
  write: Write,
): readonly [JsonObject, string] | undefined {
  if (!drive) return undefined;
  const route = drive.map(write);
  const [first, ...others] = actorsOf(scenario).filter(({ list }) => list === "ego_vehicles");
  if (!first || others.length > 0) return withActor(scenario, "ego_vehicles", route);
  const places = route.map((place) => ({ ...place }));
  return [withValue(scenario, `${first.pointer}/route`, places), first.pointer];
}

/** Returns the scenario in which one more walker crosses at a place, and the pointer to it. */
export function withWalk(
  scenario: JsonObject,
  { walk }: KindPlace,
  write: Write,
): readonly [JsonObject, string] | undefined {
  return walk && withActor(scenario, "npc_walkers", walk.map(write));
}
