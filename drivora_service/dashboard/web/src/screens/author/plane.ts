import type { NewPlace } from "./scenario";

/** Between the frame of a document and the plane of its map, both metres. */
export interface Plane {
  /** Added to the document's x. */
  readonly east: number;
  /** Added to the document's y once it points north. */
  readonly north: number;
  /** Whether the document's y points south and its yaw turns clockwise: CARLA's frame. */
  readonly mirrored: boolean;
}

/** Returns the plane of a document's frame; `offset` is the network's. */
export function planeOf(frame: unknown, offset: readonly number[] | undefined): Plane {
  if (frame !== "carla") return { east: 0, north: 0, mirrored: false };
  return { east: offset?.[0] ?? 0, north: offset?.[1] ?? 0, mirrored: true };
}

export function toMap(plane: Plane, { x, y }: { x: number; y: number }): [number, number] {
  return [x + plane.east, (plane.mirrored ? -y : y) + plane.north];
}

/** Returns radians counter-clockwise from east. */
export function yawToMap(plane: Plane, degrees: number): number {
  return ((plane.mirrored ? -degrees : degrees) * Math.PI) / 180;
}

/** Returns a place of the map as the document writes it: centimetres, and tenths of a degree. */
export function toDocument(plane: Plane, x: number, y: number, yaw?: number): NewPlace {
  const place = {
    x: rounded(x - plane.east, 2),
    y: rounded((plane.mirrored ? -1 : 1) * (y - plane.north), 2),
  };
  if (yaw === undefined) return place;
  return { ...place, yaw: rounded(((plane.mirrored ? -yaw : yaw) * 180) / Math.PI, 1) };
}

/** Never minus zero, which is written differently. */
function rounded(value: number, digits: number): number {
  return Number(value.toFixed(digits)) + 0;
}
