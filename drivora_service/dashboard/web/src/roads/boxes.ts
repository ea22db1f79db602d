/** A rectangle on the map: its centre and size in metres, its heading in radians. */
export interface Rectangle {
  readonly x: number;
  readonly y: number;
  readonly yaw: number;
  readonly length: number;
  readonly width: number;
}

/** Returns the corners of a rectangle, x and y in turn, counter-clockwise from the front left. */
export function outlineOf({ x, y, yaw, length, width }: Rectangle): number[] {
  const ahead = [0.5 * length * Math.cos(yaw), 0.5 * length * Math.sin(yaw)] as const;
  const left = [-0.5 * width * Math.sin(yaw), 0.5 * width * Math.cos(yaw)] as const;
  return [
    [1, 1],
    [-1, 1],
    [-1, -1],
    [1, -1],
  ].flatMap(([along = 0, across = 0]) => [
    x + along * ahead[0] + across * left[0],
    y + along * ahead[1] + across * left[1],
  ]);
}
