import type { Box } from "../../roads/camera";
import type { ShownActor } from "./shownActors";

/** Returns the box around points, x and y in turn, with a margin in metres. */
export function boxOf(points: readonly number[], margin: number): Box {
  const xs = points.filter((_, place) => place % 2 === 0);
  const ys = points.filter((_, place) => place % 2 === 1);
  return [
    Math.min(...xs) - margin,
    Math.min(...ys) - margin,
    Math.max(...xs) + margin,
    Math.max(...ys) + margin,
  ];
}

/** Returns the box of all actors and their ways; undefined without any. */
export function extentOfActors(actors: readonly ShownActor[]): Box | undefined {
  const points = actors.flatMap(({ places, path }) => [
    ...places.flatMap(({ x, y }) => [x, y]),
    ...path,
  ]);
  return points.length > 0 ? boxOf(points, 25) : undefined;
}
