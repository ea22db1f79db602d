import type { RecordBatch } from "apache-arrow";

export type Role = "ego" | "npc_vehicle" | "npc_walker" | "npc_obstacle" | "background";

export interface Actor {
  readonly row: number;
  readonly id: string;
  readonly role: Role;
  readonly model: string;
  /** Metres along the heading, and across it. */
  readonly length: number;
  readonly width: number;
}

/** The path that was planned for an ego before the run. */
export interface Route {
  readonly line: readonly number[];
  readonly goal: readonly [number, number];
  readonly length: number;
}

/** A slippery rectangle of the road: metres, radians. */
export interface FrictionPatch {
  readonly id: string;
  readonly x: number;
  readonly y: number;
  readonly yaw: number;
  readonly length: number;
  readonly width: number;
  readonly friction: number;
}

export interface LightChange {
  readonly step: number;
  readonly state: string;
}

export interface LogLine {
  readonly step: number;
  readonly ego: number;
  readonly message: string;
}

interface Head {
  readonly network: string;
  readonly step_length: number;
  readonly steps: number;
  readonly actors: readonly Omit<Actor, "row">[];
  readonly egos: readonly {
    readonly end: string;
    readonly end_step: number;
    readonly route: { readonly length: number; readonly goal: number[]; readonly line_f8: string };
  }[];
  readonly contacts: readonly (readonly [number, number, number])[];
  readonly lights: {
    readonly states: readonly string[];
    readonly changes: Readonly<Record<string, readonly (readonly [number, number])[]>>;
  };
  readonly logs: { readonly events: readonly (readonly [number, number, string])[] };
  readonly meta?: {
    readonly perception_range?: number;
    readonly friction_patches?: readonly FrictionPatch[];
  };
}

export const COLUMNS = ["x", "y", "yaw", "vx", "vy", "ax", "ay"] as const;
export const EGO_COLUMNS = ["ego_acceleration", "ego_steer", "ego_route_s"] as const;

/** A run as arrays: a value of an actor at a step is at `step × actors + row`, NaN while absent. */
export class Recording {
  readonly network: string;
  readonly stepLength: number;
  readonly steps: number;
  readonly actors: readonly Actor[];
  readonly egos: number;
  readonly ends: readonly { readonly end: string; readonly step: number }[];
  readonly routes: readonly Route[];
  readonly lights: ReadonlyMap<string, readonly LightChange[]>;
  readonly log: readonly LogLine[];
  readonly perceptionRange: number | undefined;
  readonly patches: readonly FrictionPatch[];
  /** Steps that are there already: a run is shown while the rest of it comes. */
  loaded = 0;

  readonly x: Float32Array;
  readonly y: Float32Array;
  readonly yaw: Float32Array;
  /** m/s, and along the heading m/s². */
  readonly speed: Float32Array;
  readonly acceleration: Float32Array;
  /** By ego: at `step × egos + row`. */
  readonly askedAcceleration: Float32Array;
  readonly steer: Float32Array;
  readonly routeS: Float32Array;

  constructor(head: Head) {
    this.network = head.network;
    this.stepLength = head.step_length;
    this.steps = head.steps;
    this.actors = head.actors.map((actor, row) => ({ ...actor, row }));
    this.egos = head.egos.length;
    this.ends = head.egos.map(({ end, end_step }) => ({ end, step: end_step }));
    this.routes = head.egos.map(({ route }) => ({
      line: [...doubles(route.line_f8)],
      goal: [route.goal[0] ?? Number.NaN, route.goal[1] ?? Number.NaN],
      length: route.length,
    }));
    const { states, changes } = head.lights;
    this.lights = new Map(
      Object.entries(changes).map(([id, found]) => [
        id,
        found.map(([step, state]) => ({ step, state: states[state] ?? "" })),
      ]),
    );
    this.log = head.logs.events.map(([step, ego, message]) => ({ step, ego, message }));
    this.perceptionRange = head.meta?.perception_range;
    this.patches = head.meta?.friction_patches ?? [];
    const cells = this.steps * this.actors.length;
    const empty = (size: number) => new Float32Array(size).fill(Number.NaN);
    this.x = empty(cells);
    this.y = empty(cells);
    this.yaw = empty(cells);
    this.speed = empty(cells);
    this.acceleration = empty(cells);
    this.askedAcceleration = empty(this.steps * this.egos);
    this.steer = empty(this.steps * this.egos);
    this.routeS = empty(this.steps * this.egos);
  }

  get duration(): number {
    return (this.steps - 1) * this.stepLength;
  }

  /** Takes the rows of a batch over; batches come in order and hold whole steps. */
  add(batch: RecordBatch): void {
    const steps = column(batch, "step");
    const rows = column(batch, "actor");
    const [x, y, yaw, vx, vy, ax, ay] = COLUMNS.map((name) => column(batch, name)) as Seven;
    const [asked, steer, routeS] = EGO_COLUMNS.map((name) => column(batch, name)) as Three;
    const count = this.actors.length;
    for (let k = 0; k < batch.numRows; k++) {
      const step = steps[k] as number;
      const row = rows[k] as number;
      const cell = step * count + row;
      const heading = yaw[k] as number;
      this.x[cell] = x[k] as number;
      this.y[cell] = y[k] as number;
      this.yaw[cell] = heading;
      this.speed[cell] = Math.hypot(vx[k] as number, vy[k] as number);
      this.acceleration[cell] =
        (ax[k] as number) * Math.cos(heading) + (ay[k] as number) * Math.sin(heading);
      if (row < this.egos) {
        const ego = step * this.egos + row;
        this.askedAcceleration[ego] = asked[k] as number;
        this.steer[ego] = steer[k] as number;
        this.routeS[ego] = routeS[k] as number;
      }
    }
    const last = steps[batch.numRows - 1];
    if (last !== undefined) this.loaded = last + 1;
  }

  /** Returns the state of a light at a step, "" before the first one that is known. */
  stateOf(light: string, step: number): string {
    let state = "";
    for (const change of this.lights.get(light) ?? []) {
      if (change.step > step) break;
      state = change.state;
    }
    return state;
  }

  /** Returns the first and the last step of an actor's presence. */
  presence(row: number): readonly [number, number] | undefined {
    const count = this.actors.length;
    let first = -1;
    let last = -1;
    for (let step = 0; step < this.loaded; step++) {
      if (Number.isNaN(this.x[step * count + row])) continue;
      if (first < 0) first = step;
      last = step;
    }
    return first < 0 ? undefined : [first, last];
  }
}

type Numbers = Float64Array | Int32Array | Int16Array;
type Seven = [Numbers, Numbers, Numbers, Numbers, Numbers, Numbers, Numbers];
type Three = [Numbers, Numbers, Numbers];

function column(batch: RecordBatch, name: string): Numbers {
  const values = batch.getChild(name)?.data[0]?.values;
  if (values === undefined) throw new Error(`the recording has no column ${name}`);
  return values as Numbers;
}

/** Reads little-endian doubles in base64. */
export function doubles(text: string): Float64Array {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Float64Array(bytes.buffer);
}
