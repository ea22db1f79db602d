import type { LaneIndex } from "../../roads/laneIndex";
import { placeAt } from "../../roads/lines";
import type { ListName } from "./scenario";

/** A place of the map. */
export interface Snapped {
  readonly x: number;
  readonly y: number;
  /** Heading of the lane, radians; undefined where no lane gives one. */
  readonly yaw: number | undefined;
  /** The lane; "" where the place is free. */
  readonly lane: string;
}

/** Returns the place that is meant by a pointer: vehicles go to the middle of their lane. */
export function snapped(
  index: LaneIndex,
  list: ListName,
  x: number,
  y: number,
  { free = false }: { readonly free?: boolean } = {},
): Snapped {
  const here = { x, y, yaw: undefined, lane: "" };
  if (free || list === "npc_walkers") return here;
  const found = index.at(x, y, (lane) => lane.drivable);
  if (!found) return here;
  const place = placeAt(index.lineOf(found.lane), found.offset);
  // What stands beside the middle on purpose keeps its place, with the heading of the lane.
  const at = list === "npc_obstacles" || list === "friction_patches" ? { x, y } : place;
  return { x: at.x, y: at.y, yaw: place.heading, lane: found.lane.id };
}
