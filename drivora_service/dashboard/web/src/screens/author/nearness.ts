import { footOn, lengthOf, placeAt } from "../../roads/lines";
import type { KindPlace } from "./places";

const ON_WAY_M = 4;

/** Returns whether one of some ways leads over a place. */
export function isOnWay({ line }: KindPlace, ways: readonly (readonly number[])[]): boolean {
  const { x, y } = placeAt(line, lengthOf(line) / 2);
  const reach = Math.max(ON_WAY_M, lengthOf(line) / 2);
  return ways.some((way) => way.length > 2 && footOn(way, x, y).distance < reach);
}

/** Returns places with those first over which a way leads. */
export function onWayFirst(
  places: readonly KindPlace[],
  ways: readonly (readonly number[])[],
): readonly { readonly place: KindPlace; readonly isOnWay: boolean }[] {
  const seen = places.map((place) => ({ place, isOnWay: isOnWay(place, ways) }));
  return [...seen.filter((one) => one.isOnWay), ...seen.filter((one) => !one.isOnWay)];
}
