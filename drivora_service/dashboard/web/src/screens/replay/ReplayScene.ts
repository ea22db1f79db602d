import { Container, Graphics, Text } from "pixi.js";
import type { Schemas } from "../../api/client";
import { colourOfActor } from "../../roads/actorShapes";
import { type Box, type Camera, type Size, toScreen } from "../../roads/camera";
import { dashes } from "../../roads/lines";
import { patchLayer } from "../../roads/patchLayer";
import type { DrawnMap } from "../../roads/RoadMap";
import { trace } from "../../roads/roadLayer";
import { ActorLayer, type Look } from "./actorLayer";
import { PerceptionLayer } from "./PerceptionLayer";
import { PlanLayer } from "./PlanLayer";
import type { PerceivedActors } from "./perception";
import type { AgentTold } from "./plans";
import type { Recording } from "./recording";
import { TrailLayer } from "./trailLayer";
import { toneOf } from "./verdictWords";

const ROUTE_M = 0.28;
const LABEL_AWAY_PX = 14;
const MARK_PX = 9;
const MARK_NEAR_S = 2;
/** With more marks than this, those of other moments have no number. */
const MOST_NUMBERED = 6;
const LEAST_SIDE_M = 60;

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
  private readonly labels = new Map<number, Text>();
  private readonly overlay = new Container();
  private readonly marks: {
    readonly node: Container;
    /** The number, and what joins it to the place. */
    readonly numbered: Container;
    readonly x: number;
    readonly y: number;
    readonly time: number;
  }[] = [];
  private readonly names = new Container();
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
    private readonly look: Look = "whole",
  ) {
    this.routes = routesOf(recording, map.palette.egos);
    this.actors = new ActorLayer(recording, map.palette, look);
    // The run that is compared has the same road.
    if (look === "whole") this.below.addChild(patchLayer(recording.patches, map.palette));
    map.stage.world.addChild(this.below, this.routes, this.actors);
    map.stage.screen.addChild(this.overlay, this.names);
    for (const actor of recording.actors) if (actor.role === "ego") this.label(actor.row);
  }

  set(options: SceneOptions): void {
    this.options = options;
    this.routes.visible = options.routes;
    this.actors.hidden.clear();
    for (const row of options.hidden) this.actors.hidden.add(row);
    if (options.followed !== undefined) this.label(options.followed);
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
    for (const { node } of this.marks) node.destroy({ children: true });
    this.marks.length = 0;
    const { palette } = this.map;
    const taken = new Map<string, number>();
    const colours = { bad: palette.violation, lost: palette.lost, quiet: palette.npc };
    for (const violation of violations) {
      const { number, location, first } = violation;
      if (!location) continue;
      const [x, y] = location as [number, number];
      const colour = colours[toneOf(violation)];
      const key = `${x.toFixed(0)} ${y.toFixed(0)}`;
      const beside = taken.get(key) ?? 0;
      taken.set(key, beside + 1);
      const node = new Container();
      const centre = 2.1 * MARK_PX * (beside + 1);
      const cross = new Graphics()
        .moveTo(-4, -4)
        .lineTo(4, 4)
        .moveTo(-4, 4)
        .lineTo(4, -4)
        .stroke({ width: 2, color: colour });
      const numbered = new Container();
      const badge = new Graphics()
        .moveTo(0, 0)
        .lineTo(centre, -2 * MARK_PX)
        .stroke({ width: 1.2, color: colour })
        .circle(centre, -2 * MARK_PX, MARK_PX)
        .fill(colour)
        .stroke({ width: 1.2, color: palette.casing });
      const text = new Text({
        text: String(number),
        style: { fontFamily: "sans-serif", fontSize: 11, fontWeight: "600", fill: palette.casing },
        resolution: 2,
      });
      text.anchor.set(0.5);
      text.position.set(centre, -2 * MARK_PX);
      numbered.addChild(badge, text);
      node.addChild(cross, numbered);
      this.overlay.addChild(node);
      this.marks.push({ node, numbered, x, y, time: (first ?? 0) * this.recording.stepLength });
    }
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
    for (const [row, text] of this.labels) {
      const place = this.placeOf(row, time);
      text.visible = place !== undefined && !this.options.hidden.has(row);
      if (!place || !text.visible) continue;
      const [left, top] = toScreen(camera, size, place[0], place[1]);
      const actor = recording.actors[row];
      const half = 0.5 * Math.max(actor?.width ?? 0, 1) * camera.scale;
      const away = Math.max(half, 4) + LABEL_AWAY_PX;
      // Below the outline of a second run, above those of the first: they may be at one place.
      text.position.set(left, this.look === "outline" ? top + away : top - away);
    }
    const few = this.marks.length <= MOST_NUMBERED;
    for (const { node, numbered, x, y, time: moment } of this.marks) {
      // Marks of other moments stay in the background.
      const near = Math.abs(time - moment) < MARK_NEAR_S;
      node.alpha = near ? 1 : 0.4;
      numbered.visible = near || few;
      const [left, top] = toScreen(camera, size, x, y);
      node.position.set(left, top);
    }
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

  /** Returns the box of the egos' ways and destinations. */
  extent(): Box {
    const { recording } = this;
    const count = recording.actors.length;
    let [west, south, east, north] = [Infinity, Infinity, -Infinity, -Infinity];
    const hold = (x: number, y: number) => {
      if (Number.isNaN(x)) return;
      west = Math.min(west, x);
      south = Math.min(south, y);
      east = Math.max(east, x);
      north = Math.max(north, y);
    };
    for (let step = 0; step < recording.loaded; step++)
      for (let ego = 0; ego < recording.egos; ego++) {
        const cell = step * count + ego;
        hold(recording.x[cell] as number, recording.y[cell] as number);
      }
    if (west > east) return [0, 0, LEAST_SIDE_M, LEAST_SIDE_M];
    const x = (west + east) / 2;
    const y = (south + north) / 2;
    const across = Math.max(east - west + 24, LEAST_SIDE_M) / 2;
    const along = Math.max(north - south + 24, LEAST_SIDE_M) / 2;
    return [x - across, y - along, x + across, y + along];
  }

  destroy(): void {
    for (const part of [this.below, this.routes, this.actors, this.overlay, this.names])
      part.destroy({ children: true });
    this.perception?.destroy({ children: true });
  }

  private label(row: number): void {
    const actor = this.recording.actors[row];
    if (!actor || this.labels.has(row)) return;
    const { palette } = this.map;
    const text = new Text({
      text: this.look === "outline" ? `${actor.id} 2nd` : actor.id,
      style: {
        fontFamily: "sans-serif",
        fontSize: 12,
        fontWeight: "600",
        fill: colourOfActor(actor, palette),
        stroke: { color: palette.casing, width: 3, join: "round" },
      },
      resolution: 2,
    });
    text.anchor.set(0.5, 0.5);
    this.labels.set(row, text);
    this.names.addChild(text);
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
