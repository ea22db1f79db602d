import type { Schemas } from "../../api/client";
import { flat, lengthOf, partOf, placeAt } from "../../roads/lines";
import type { Snapped } from "./snapping";

type Geometry = Schemas["NetworkGeometry"];

/** The kinds of places that can be searched, in words. */
export const PLACE_KINDS = [
  "left turn that gives way",
  "left turn with its own green",
  "right turn",
  "junction with lights",
  "junction without lights",
  "crossing",
  "road of several lanes",
] as const;
export type PlaceKind = (typeof PLACE_KINDS)[number];

/** A place of a network, with what a situation there needs. */
export interface KindPlace {
  readonly kind: PlaceKind;
  readonly id: string;
  readonly name: string;
  readonly lanes: readonly string[];
  /** Points that show where it is, x and y in turn. */
  readonly line: readonly number[];
  /** Start and destination of a vehicle that drives through it. */
  readonly drive: readonly [Snapped, Snapped] | undefined;
  /** Start and destination of a walker across it. */
  readonly walk: readonly [Snapped, Snapped] | undefined;
}

/** Metres before and behind a turn at which a drive through it begins and ends. */
const AROUND_M = 45;
/** Metres on either side of a crossing at which a walk begins and ends. */
const BESIDE_M = 1.5;

/** Returns the places of a kind in the order of their names. */
export function placesOf(geometry: Geometry, kind: PlaceKind): readonly KindPlace[] {
  const found = finders[kind](geometry);
  return found.toSorted((a, b) => a.name.localeCompare(b.name, undefined, { numeric: true }));
}

const finders: Readonly<Record<PlaceKind, (geometry: Geometry) => KindPlace[]>> = {
  "left turn that gives way": (geometry) => turns(geometry, "left turn that gives way"),
  "left turn with its own green": (geometry) => turns(geometry, "left turn with its own green"),
  "right turn": (geometry) => turns(geometry, "right turn"),
  "junction with lights": (geometry) => junctions(geometry, "junction with lights"),
  "junction without lights": (geometry) => junctions(geometry, "junction without lights"),
  crossing: crossings,
  "road of several lanes": roads,
};

function turns(geometry: Geometry, wanted: PlaceKind): KindPlace[] {
  const lanes = new Map(geometry.lanes.map((lane) => [lane.id, lane]));
  const lights = new Map(geometry.traffic_lights.map((light) => [light.id, light]));
  return geometry.stop_lines.flatMap((stop) =>
    stop.movements.flatMap((movement) => {
      const right = movement.direction === "r";
      const left = movement.direction === "l";
      if (!right && !left) return [];
      const light = lights.get(stop.light);
      const states = light?.phases.map(({ state }) => state[movement.link]) ?? [];
      // A small g is green that gives way to those who come.
      const gives = light ? states.includes("g") : /[ms=w]/.test(movement.right_of_way);
      const protectedTurn = light !== undefined && states.includes("G") && !states.includes("g");
      const kind: PlaceKind | undefined = right
        ? "right turn"
        : gives
          ? "left turn that gives way"
          : protectedTurn
            ? "left turn with its own green"
            : undefined;
      const from = lanes.get(stop.lane);
      if (kind !== wanted || !from?.drivable) return [];
      const via = movement.via.flatMap((id) => lanes.get(id) ?? []);
      const onto = laneAfter(geometry, via.at(-1) ?? from, movement.to_edge);
      const before = flat(from.shape);
      const length = lengthOf(before);
      const part = partOf(before, Math.max(length - AROUND_M, 0), length);
      const behind = onto ? partOf(flat(onto.shape), 0, AROUND_M) : [];
      return [
        {
          kind,
          id: `${stop.lane} ${movement.to_edge} ${movement.link}`,
          name: `${street(from)} to ${onto ? street(onto) : movement.to_edge}, from the ${whence(before)}`,
          lanes: [from.id, ...movement.via, ...(onto ? [onto.id] : [])],
          line: [...part, ...via.flatMap((lane) => flat(lane.shape)), ...behind],
          drive: onto && [
            on(from.id, before, Math.max(length - AROUND_M, Math.min(5, length / 2))),
            on(onto.id, flat(onto.shape), AROUND_M),
          ],
          walk: undefined,
        } satisfies KindPlace,
      ];
    }),
  );
}

const WINDS = [
  "east",
  "north-east",
  "north",
  "north-west",
  "west",
  "south-west",
  "south",
  "south-east",
];

/** Returns the point of the compass in a direction, radians from east. */
function windOf(direction: number): string {
  const eighth = Math.round((4 * direction) / Math.PI);
  return WINDS[((eighth % 8) + 8) % 8] ?? "";
}

/** Returns where those come from who drive along a line. */
function whence(line: readonly number[]): string {
  return windOf(placeAt(line, lengthOf(line)).heading + Math.PI);
}

/** Returns the drivable lane of an edge that begins where another ends. */
function laneAfter(
  geometry: Geometry,
  before: Schemas["LaneGeometry"],
  edge: string,
): Schemas["LaneGeometry"] | undefined {
  const [x = 0, y = 0] = before.shape.at(-1) ?? [];
  const away = ({ shape: [begin] }: Schemas["LaneGeometry"]) =>
    Math.hypot((begin?.[0] ?? Number.POSITIVE_INFINITY) - x, (begin?.[1] ?? 0) - y);
  const lanes = geometry.lanes.filter((lane) => lane.edge === edge && lane.drivable);
  return lanes.toSorted((a, b) => away(a) - away(b))[0];
}

function street(lane: Schemas["LaneGeometry"]): string {
  return lane.street || lane.edge;
}

function on(lane: string, line: readonly number[], distance: number): Snapped {
  const { x, y, heading } = placeAt(line, Math.min(distance, Math.max(lengthOf(line) - 2, 0)));
  return { x, y, yaw: heading, lane };
}

function junctions(geometry: Geometry, kind: PlaceKind): KindPlace[] {
  return Object.entries(geometry.junctions).flatMap(([id, outline]) => {
    const type = geometry.junction_types[id] ?? "";
    const lit = type.startsWith("traffic_light");
    if (type === "dead_end" || lit !== (kind === "junction with lights")) return [];
    // A node in the middle of a road is no junction for its drivers.
    const arms = new Set(
      geometry.stop_lines.filter(({ junction }) => junction === id).map(({ lane }) => lane),
    );
    if (!lit && arms.size < 2) return [];
    const name = `${id}, ${type.replaceAll("_", " ")}`;
    return [{ kind, id, name, lanes: [], line: flat(outline), drive: undefined, walk: undefined }];
  });
}

/** Returns on which side of a junction a place is. */
function armOf(geometry: Geometry, junction: string, { x, y }: { x: number; y: number }): string {
  const outline = geometry.junctions[junction] ?? [];
  const mean = (axis: 0 | 1) =>
    outline.reduce((sum, point) => sum + (point[axis] ?? 0), 0) / Math.max(outline.length, 1);
  return windOf(Math.atan2(y - mean(1), x - mean(0)));
}

function crossings(geometry: Geometry): KindPlace[] {
  const edges = new Map(geometry.lanes.map((lane) => [lane.edge, lane]));
  return geometry.crossings.map((crossing) => {
    const line = flat(crossing.shape);
    const length = lengthOf(line);
    const begin = placeAt(line, 0);
    const end = placeAt(line, length);
    const beyond = ({ x, y, heading }: typeof begin, by: number): Snapped => ({
      x: x + by * Math.cos(heading),
      y: y + by * Math.sin(heading),
      yaw: undefined,
      lane: "",
    });
    const across = crossing.edges.flatMap((edge) => edges.get(edge)?.street || []);
    const middle = placeAt(line, length / 2);
    const name = [
      [...new Set(across)].join(", ") || "Crossing",
      `${armOf(geometry, crossing.junction, middle)} of ${crossing.junction}`,
      ...(crossing.light ? ["with lights"] : []),
    ].join(", ");
    return {
      kind: "crossing",
      id: crossing.id,
      name,
      lanes: [crossing.id],
      line,
      drive: undefined,
      walk: [beyond(begin, -BESIDE_M), beyond(end, BESIDE_M)],
    };
  });
}

function roads(geometry: Geometry): KindPlace[] {
  const byEdge = new Map<string, Schemas["LaneGeometry"][]>();
  for (const lane of geometry.lanes)
    if (lane.drivable && lane.kind === "road")
      byEdge.set(lane.edge, [...(byEdge.get(lane.edge) ?? []), lane]);
  return [...byEdge].flatMap(([edge, lanes]) => {
    const [first] = lanes;
    if (lanes.length < 2 || !first) return [];
    const line = flat(first.shape);
    const length = lengthOf(line);
    return [
      {
        kind: "road of several lanes",
        id: edge,
        name: `${street(first)}, ${lanes.length} lanes, ${Math.round(length)} m`,
        lanes: lanes.map(({ id }) => id),
        line,
        drive: length > 40 ? [on(first.id, line, 10), on(first.id, line, length - 10)] : undefined,
        walk: undefined,
      },
    ];
  });
}
