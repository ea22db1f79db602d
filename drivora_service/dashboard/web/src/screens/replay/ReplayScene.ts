import { Container, Graphics } from "pixi.js";
import type { Schemas } from "../../api/client";
import type { Box, Camera, Size } from "../../roads/camera";
import { dashes } from "../../roads/lines";
import { patchLayer } from "../../roads/patchLayer";
import type { DrawnMap } from "../../roads/RoadMap";
import { trace } from "../../roads/roadLayer";
import { ActorLayer, type Look } from "./actorLayer";
import { MarkLayer } from "./MarkLayer";
import { NameLayer } from "./NameLayer";
import { openingBox, wholeBox } from "./opening";
import { PerceptionLayer } from "./PerceptionLayer";
import { PlanLayer } from "./PlanLayer";
import type { PerceivedActors } from "./perception";
import type { AgentTold } from "./plans";
import type { Recording } from "./recording";
import { TrailLayer } from "./trailLayer";

const ROUTE_M = 0.28;

type Violation = Schemas["ViolationMark"];

export interface SceneOptions {
  /** Seconds of trails; 0 is none. */
  readonly trails: number;
  readonly routes: boolean;
  readonly hidden: ReadonlySet<number>;
  readonly followed: number | undefined;
}

/** What moves on the map of a run, made once for its recording. */
export class ReplayScene {
  private readonly below = new Container();
  private readonly actors: ActorLayer;
  private readonly routes: Graphics;
  private readonly marks: MarkLayer;
  private readonly names: NameLayer;
  private trails: TrailLayer | undefined;
  private trailsOf = "";
  private perception: PerceptionLayer | undefined;
  private plans: PlanLayer | undefined;
  private options: SceneOptions = {
    trails: 0,
    routes: true,
    hidden: new Set(),
    followed: undefined,
  };
  private time = 0;

  constructor(
    private readonly map: DrawnMap,
    readonly recording: Recording,
    look: Look = "whole",
  ) {
    this.routes = routesOf(recording, map.palette.egos);
    this.actors = new ActorLayer(recording, map.palette, look);
    // The run that is compared has the same road.
    if (look === "whole") this.below.addChild(patchLayer(recording.patches, map.palette));
    map.stage.world.addChild(this.below, this.routes, this.actors);
    this.marks = new MarkLayer(map.palette);
    this.names = new NameLayer(map.palette, look);
    map.stage.screen.addChild(this.marks, this.names);
    for (const actor of recording.actors) if (actor.role === "ego") this.names.add(actor);
  }

  set(options: SceneOptions): void {
    this.options = options;
    this.routes.visible = options.routes;
    this.actors.hidden.clear();
    for (const row of options.hidden) this.actors.hidden.add(row);
    const followed = this.recording.actors[options.followed ?? -1];
    if (followed) this.names.add(followed);
    this.refreshTrails();
  }

  /** Shows the paths that agents planned. */
  plan(told: AgentTold | undefined): void {
    this.plans?.destroy();
    this.plans = told?.hasPlans
      ? new PlanLayer(told, this.recording.egos, this.map.palette)
      : undefined;
    if (this.plans) this.below.addChild(this.plans);
  }

  /** Shows what an ego perceived, or the truth alone. */
  perceive(perceived: PerceivedActors | undefined): void {
    this.perception?.destroy({ children: true });
    this.perception = perceived && new PerceptionLayer(this.recording, perceived, this.map.palette);
    if (this.perception) this.map.stage.world.addChild(this.perception);
    this.actors.missed = perceived && ((step, row) => perceived.isMissed(step, row));
  }

  /** Numbers violations on the map. */
  mark(violations: readonly Violation[]): void {
    this.marks.set(violations, this.recording.stepLength);
  }

  /** Prepares a frame of a time. */
  show(time: number, camera: Camera, size: Size): void {
    this.time = time;
    const { recording } = this;
    this.actors.show(time, camera.scale);
    const step = Math.floor(time / recording.stepLength + 1e-6);
    this.perception?.show(Math.min(step, recording.loaded - 1));
    this.plans?.show(step, this.options.hidden);
    if (this.options.trails > 0) this.refreshTrails();
    this.trails?.show(time, this.options.trails, camera.scale);
    const boxes = this.actors.boxes(camera, size);
    const named = this.names.show(boxes, camera.scale);
    this.marks.show(time, camera, size, [...boxes.values(), ...named]);
  }

  /** Returns where an actor is at a time, undefined while it is absent. */
  placeOf(row: number, time: number): [number, number] | undefined {
    const { recording } = this;
    const at = Math.min(time / recording.stepLength, recording.loaded - 1);
    const step = Math.floor(at + 1e-6);
    const here = step * recording.actors.length + row;
    const x = recording.x[here];
    const y = recording.y[here];
    if (x === undefined || y === undefined || Number.isNaN(x)) return undefined;
    const there = Math.min(step + 1, recording.loaded - 1) * recording.actors.length + row;
    const share = Math.max(at - step, 0);
    const x1 = recording.x[there] as number;
    if (share === 0 || Number.isNaN(x1)) return [x, y];
    return [x + share * (x1 - x), y + share * ((recording.y[there] as number) - y)];
  }

  /** Returns the actor at a place of the map now. */
  actorAt(x: number, y: number, within: number): number | undefined {
    return this.actors.at(x, y, this.time, within)?.row;
  }

  /** Returns the box of the ways of all egos. */
  whole(): Box {
    return wholeBox(this.recording);
  }

  /** Returns the box to open with at a moment; `focus` is the row of the ego that matters most. */
  opening(size: Size, moment: number, focus: number): Box {
    return openingBox(this.recording, size, moment, focus);
  }

  destroy(): void {
    for (const part of [this.below, this.routes, this.actors, this.marks, this.names])
      part.destroy({ children: true });
    this.perception?.destroy({ children: true });
  }

  /** Makes the trails when they are wanted, and anew when steps or hidden actors have changed. */
  private refreshTrails(): void {
    const { hidden, trails } = this.options;
    if (trails <= 0) {
      if (this.trails) this.trails.visible = false;
      return;
    }
    const wanted = `${this.recording.loaded} ${[...hidden].join(" ")}`;
    if (wanted === this.trailsOf) return;
    this.trailsOf = wanted;
    this.trails?.destroy();
    this.trails = new TrailLayer(this.recording, this.map.palette, hidden);
    this.below.addChild(this.trails);
  }
}

function routesOf(recording: Recording, colours: readonly number[]): Graphics {
  const routes = new Graphics();
  recording.routes.forEach(({ line, goal }, ego) => {
    const color = colours[ego % colours.length] ?? 0;
    for (const dash of dashes(line, 1.2, 1.8)) trace(routes, dash);
    routes.stroke({ width: ROUTE_M, color, alpha: 0.65 });
    const [x, y] = goal;
    routes.circle(x, y, 1.6).stroke({ width: 0.4, color }).circle(x, y, 0.6).fill(color);
  });
  return routes;
}
