/** The part of the plane that a map shows: its middle in metres, and pixels a metre. */
export interface Camera {
  readonly x: number;
  readonly y: number;
  readonly scale: number;
}

export interface Size {
  readonly width: number;
  readonly height: number;
}

/** West, south, east and north, metres. */
export type Box = readonly [number, number, number, number];

const FARTHEST = 0.05;
const NEAREST = 120;

/** Returns the camera that shows a box with a margin in pixels. */
export function cameraOf(box: Box, size: Size, margin = 24, nearest = 20): Camera {
  const [west, south, east, north] = box;
  const across = Math.max(size.width - 2 * margin, 1) / Math.max(east - west, 1);
  const along = Math.max(size.height - 2 * margin, 1) / Math.max(north - south, 1);
  return {
    x: (west + east) / 2,
    y: (south + north) / 2,
    scale: bounded(Math.min(across, along, nearest)),
  };
}

/** Returns the camera nearer by a factor, with the point under the pointer where it was. */
export function zoomAt(
  camera: Camera,
  size: Size,
  left: number,
  top: number,
  factor: number,
): Camera {
  const [x, y] = toWorld(camera, size, left, top);
  const scale = bounded(camera.scale * factor);
  return {
    x: x - (left - size.width / 2) / scale,
    y: y + (top - size.height / 2) / scale,
    scale,
  };
}

/** Returns the place under a pixel, metres. */
export function toWorld(camera: Camera, size: Size, left: number, top: number): [number, number] {
  return [
    camera.x + (left - size.width / 2) / camera.scale,
    camera.y - (top - size.height / 2) / camera.scale,
  ];
}

/** Returns the pixel of a place. */
export function toScreen(camera: Camera, size: Size, x: number, y: number): [number, number] {
  return [
    size.width / 2 + (x - camera.x) * camera.scale,
    size.height / 2 - (y - camera.y) * camera.scale,
  ];
}

/**
 * Returns the camera moved as little as shows all places, at the same scale, with a margin in
 * pixels; of places too far apart the last is shown, and one that is out of the picture comes to its
 * middle.
 */
export function withSight(
  camera: Camera,
  size: Size,
  places: readonly (readonly [number, number])[],
  margin = 40,
): Camera {
  const across = Math.max(size.width / 2 - margin, 0) / camera.scale;
  const along = Math.max(size.height / 2 - margin, 0) / camera.scale;
  let { x, y } = camera;
  const last = places.at(-1);
  if (last && !holds(camera, size, last)) [x, y] = last;
  for (const [east, north] of places) {
    x = Math.min(Math.max(x, east - across), east + across);
    y = Math.min(Math.max(y, north - along), north + along);
  }
  return x === camera.x && y === camera.y ? camera : { ...camera, x, y };
}

function holds(camera: Camera, size: Size, [x, y]: readonly [number, number]): boolean {
  const [left, top] = toScreen(camera, size, x, y);
  return left >= 0 && left <= size.width && top >= 0 && top <= size.height;
}

/** Returns a camera as a word of an address: `120.5,88.2,6.4`. */
export function cameraText(camera: Camera): string {
  return `${camera.x.toFixed(1)},${camera.y.toFixed(1)},${Number(camera.scale.toPrecision(4))}`;
}

/** Reads the word of an address; undefined if it is none. */
export function readCamera(text: string): Camera | undefined {
  const [x, y, scale] = text.split(",").map(Number);
  if (x === undefined || y === undefined || !scale) return undefined;
  if (![x, y, scale].every(Number.isFinite)) return undefined;
  return { x, y, scale: bounded(scale) };
}

/** Returns a round length for a scale bar of about 100 pixels, metres. */
export function scaleBar(scale: number): number {
  const most = 110 / scale;
  const power = 10 ** Math.floor(Math.log10(most));
  for (const step of [5, 2]) if (step * power <= most) return step * power;
  return power;
}

function bounded(scale: number): number {
  return Math.min(Math.max(scale, FARTHEST), NEAREST);
}
