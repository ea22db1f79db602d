import type { Schemas } from "../../api/client";
import type { Box } from "../../roads/camera";
import { flat } from "../../roads/lines";

type Geometry = Schemas["NetworkGeometry"];

/** A part of a network that can be found by its name. */
export interface Part {
  readonly what: "lane" | "edge" | "junction" | "street" | "traffic light";
  readonly id: string;
}

const MOST = 60;

/** Returns the parts whose names hold a text; those that begin with it come first. */
export function partsNamed(geometry: Geometry, text: string): readonly Part[] {
  const wanted = text.trim().toLowerCase();
  if (!wanted) return [];
  const found: { part: Part; rank: number }[] = [];
  const seen = new Set<string>();
  const add = (what: Part["what"], id: string) => {
    const place = id.toLowerCase().indexOf(wanted);
    if (place < 0 || seen.has(`${what} ${id}`)) return;
    seen.add(`${what} ${id}`);
    found.push({ part: { what, id }, rank: (id.length === wanted.length ? 0 : 1) + place });
  };
  for (const { id } of geometry.traffic_lights) add("traffic light", id);
  for (const id of Object.keys(geometry.junctions)) add("junction", id);
  for (const lane of geometry.lanes) {
    if (lane.street) add("street", lane.street);
    if (!lane.internal) add("edge", lane.edge);
  }
  for (const lane of geometry.lanes) add("lane", lane.id);
  return found
    .sort((a, b) => a.rank - b.rank)
    .slice(0, MOST)
    .map(({ part }) => part);
}

/** Returns the lanes of a part, and its box with a margin. */
export function extentOf(geometry: Geometry, { what, id }: Part): { lanes: string[]; box: Box } {
  const light = what === "traffic light" && geometry.traffic_lights.find((one) => one.id === id);
  const approaches = new Set(
    // Signals of walkers have no stop line.
    light ? light.links.filter((link) => link.stop_line).map((link) => link.lane) : [],
  );
  const lanes = geometry.lanes.filter(
    (lane) =>
      (what === "lane" && lane.id === id) ||
      (what === "edge" && lane.edge === id) ||
      (what === "street" && lane.street === id) ||
      approaches.has(lane.id),
  );
  const outline = what === "junction" ? (geometry.junctions[id] ?? []) : [];
  const points = [
    ...flat(outline),
    ...(light ? light.links.flatMap((link) => flat(link.stop_line ?? [])) : []),
    ...(light ? [] : lanes.flatMap((lane) => flat(lane.shape))),
  ];
  const xs = points.filter((_, place) => place % 2 === 0);
  const ys = points.filter((_, place) => place % 2 === 1);
  const margin = 12;
  return {
    lanes: lanes.map((lane) => lane.id),
    box: [
      Math.min(...xs) - margin,
      Math.min(...ys) - margin,
      Math.max(...xs) + margin,
      Math.max(...ys) + margin,
    ],
  };
}
