import { Container, Graphics, Text } from "pixi.js";
import { colourOfActor, wholeShape } from "../../roads/actorShapes";
import { outlineOf, type Rectangle } from "../../roads/boxes";
import { type Camera, type Size, toScreen } from "../../roads/camera";
import { dashes } from "../../roads/lines";
import { patchLayer } from "../../roads/patchLayer";
import type { DrawnMap } from "../../roads/RoadMap";
import { trace } from "../../roads/roadLayer";
import type { ListName } from "./scenario";
import type { ShownActor } from "./shownActors";

const HANDLE_PX = 6;
const NAME_AWAY_PX = 16;
const SMALLEST_PX = 7;
const THINNEST_PX = 1.6;
const ROLES: Readonly<Record<ListName, string>> = {
  ego_vehicles: "ego",
  npc_vehicles: "npc_vehicle",
  npc_walkers: "npc_walker",
  npc_obstacles: "npc_obstacle",
  friction_patches: "patch",
};

/** What would be placed by a click. */
export interface Ghost {
  readonly list: ListName;
  readonly x: number;
  readonly y: number;
  readonly yaw: number;
  /** Where its route goes on from. */
  readonly from: readonly [number, number] | undefined;
}

export interface Chosen {
  readonly actor: string;
  readonly place: string;
}

/** The actors of a scenario that is written, with their ways and the handles of the chosen one. */
export class AuthorLayer {
  private readonly ground = new Container();
  private readonly ways = new Graphics();
  private readonly bodies = new Container();
  private readonly ghost = new Container();
  private readonly handles = new Graphics();
  private readonly names = new Container();
  private readonly nodes: { readonly actor: ShownActor; readonly node: Container }[] = [];
  private actors: readonly ShownActor[] = [];
  private chosen: Chosen = { actor: "", place: "" };
  /** Pixels a metre for which the ways are drawn. */
  private scale = 1;
  private labels: { readonly text: Text; readonly x: number; readonly y: number }[] = [];

  constructor(private readonly map: DrawnMap) {
    map.stage.world.addChild(this.ground, this.ways, this.bodies, this.ghost);
    map.stage.screen.addChild(this.handles, this.names);
  }

  set(actors: readonly ShownActor[], chosen: Chosen): void {
    this.actors = actors;
    this.chosen = chosen;
    this.drawGround();
    this.drawWays();
    for (const child of this.bodies.removeChildren()) child.destroy({ children: true });
    this.nodes.length = 0;
    // The egos come first in a document and are drawn above the others.
    for (const actor of actors.toReversed())
      if (actor.list !== "friction_patches") this.addBody(actor);
    this.drawNames();
  }

  /** Shows what a click would place; undefined shows nothing. */
  point(ghost: Ghost | undefined): void {
    for (const child of this.ghost.removeChildren()) child.destroy();
    if (!ghost) return;
    const { palette } = this.map;
    const role = ROLES[ghost.list];
    const color = colourOfActor({ role, row: 0 }, palette);
    if (ghost.from) {
      const line = new Graphics();
      for (const dash of dashes([...ghost.from, ghost.x, ghost.y], 1.2, 1)) trace(line, dash);
      line.stroke({ width: 0.35, color, alpha: 0.8 });
      line.circle(ghost.x, ghost.y, 0.9).fill({ color, alpha: 0.6 });
      this.ghost.addChild(line);
      return;
    }
    const [length, width] = role === "npc_walker" ? [0.5, 0.5] : [4.8, 2];
    const body = new Graphics(wholeShape({ role, length, width }, color, palette));
    body.position.set(ghost.x, ghost.y);
    body.rotation = ghost.yaw;
    body.alpha = 0.55;
    this.ghost.addChild(body);
  }

  /** Places what keeps its size on the screen. */
  show(camera: Camera, size: Size): void {
    if (Math.abs(Math.log(camera.scale / this.scale)) > 0.25) {
      this.scale = camera.scale;
      this.drawWays();
    }
    for (const { actor, node } of this.nodes)
      node.scale.set(Math.max(1, SMALLEST_PX / (Math.max(actor.width, 0.4) * camera.scale)));
    for (const { text, x, y } of this.labels) {
      const [left, top] = toScreen(camera, size, x, y);
      text.position.set(left, top - NAME_AWAY_PX);
    }
    this.handles.clear();
    const { palette } = this.map;
    const chosen = this.actors.find(({ pointer }) => pointer === this.chosen.actor);
    if (!chosen) return;
    for (const place of chosen.places) {
      const [left, top] = toScreen(camera, size, place.x, place.y);
      const isChosen = place.pointer === this.chosen.place;
      this.handles
        .circle(left, top, isChosen ? HANDLE_PX + 2 : HANDLE_PX)
        .fill(isChosen ? palette.accent : palette.casing)
        .stroke({ width: 2, color: isChosen ? palette.casing : palette.accent });
    }
  }

  private drawGround(): void {
    const { palette } = this.map;
    for (const child of this.ground.removeChildren()) child.destroy();
    const patches = this.actors.filter(({ list }) => list === "friction_patches");
    const known = patches.map((patch) => ({ ...patch, friction: patch.friction ?? 1 }));
    this.ground.addChild(patchLayer(known, palette));
    for (const patch of patches) {
      const isChosen = patch.pointer === this.chosen.actor;
      if (!isChosen && !patch.hasProblem) continue;
      const color = patch.hasProblem ? palette.violation : palette.accent;
      const edge = new Graphics().poly(around(patch, 0.3)).stroke({ width: 0.35, color });
      this.ground.addChild(edge);
    }
  }

  private drawWays(): void {
    const { palette } = this.map;
    this.ways.clear();
    const thinnest = THINNEST_PX / this.scale;
    for (const actor of this.actors) {
      const isChosen = actor.pointer === this.chosen.actor;
      const color = colourOfActor({ role: ROLES[actor.list], row: actor.row }, palette);
      const alpha = isChosen ? 0.9 : 0.5;
      if (actor.path.length > 2) {
        trace(this.ways, actor.path);
        const width = Math.max(isChosen ? 0.6 : 0.35, isChosen ? 2 * thinnest : thinnest);
        this.ways.stroke({ width, color, alpha, cap: "round" });
      }
      const last = actor.places.at(-1);
      if (last && actor.places.length > 1)
        this.ways
          .circle(last.x, last.y, Math.max(isChosen ? 1.1 : 0.8, 2 * thinnest))
          .fill({ color, alpha });
    }
  }

  private addBody(actor: ShownActor): void {
    const { palette } = this.map;
    const role = ROLES[actor.list];
    const node = new Container();
    const color = colourOfActor({ role, row: actor.row }, palette);
    const isChosen = actor.pointer === this.chosen.actor;
    if (isChosen || actor.hasProblem) {
      const width = 0.08 + 0.12 * Math.min(actor.width, 2);
      node.addChild(
        new Graphics()
          .poly(around({ ...actor, x: 0, y: 0, yaw: 0 }, 2 * width))
          .stroke({ width, color: actor.hasProblem ? palette.violation : palette.accent }),
      );
    }
    node.addChild(new Graphics(wholeShape({ ...actor, role }, color, palette)));
    node.position.set(actor.x, actor.y);
    node.rotation = actor.yaw;
    this.bodies.addChild(node);
    this.nodes.push({ actor, node });
  }

  private drawNames(): void {
    const { palette } = this.map;
    for (const child of this.names.removeChildren()) child.destroy();
    const named = this.actors.filter(
      ({ pointer, list }) => list === "ego_vehicles" || pointer === this.chosen.actor,
    );
    this.labels = named.map(({ id, x, y, hasProblem }) => {
      const style = {
        fontFamily: "sans-serif",
        fontSize: 12,
        fontWeight: "600",
        fill: hasProblem ? palette.violation : palette.ink,
        stroke: { color: palette.casing, width: 4, join: "round" },
      } as const;
      const text = new Text({ text: id, style, resolution: 2 });
      text.anchor.set(0.5, 1);
      this.names.addChild(text);
      return { text, x, y };
    });
  }
}

function around(box: Rectangle, margin: number): number[] {
  return outlineOf({ ...box, length: box.length + 2 * margin, width: box.width + 2 * margin });
}
