import { Container, Graphics, GraphicsContext } from "pixi.js";
import { colourOfActor, wholeShape } from "../../roads/actorShapes";
import { type Camera, type Size, toScreen } from "../../roads/camera";
import type { Palette } from "../../roads/palette";
import type { PixelBox } from "../../roads/signPlaces";
import type { Actor, Recording } from "./recording";

/** Actors smaller than this on the screen are drawn larger, in pixels across. */
const SMALLEST_PX = 7;
const SMALLEST_WALKER_PX = 9;
const BRAKING = -0.5;
const MISSED_ALPHA = 0.3;
const ARROW_M_PER_MPS2 = 0.7;

interface Drawn {
  readonly actor: Actor;
  readonly node: Container;
  readonly brake: Graphics | undefined;
  readonly push: Graphics | undefined;
  readonly wheels: Container | undefined;
}

export type Look = "whole" | "outline";

/** All actors of a recording at a time. Their objects are made once and moved. */
export class ActorLayer extends Container {
  readonly hidden = new Set<number>();
  /** Whether an ego missed an actor at a step; such actors are pale. */
  missed: ((step: number, row: number) => boolean) | undefined;
  private readonly drawn: readonly Drawn[];

  constructor(
    private readonly recording: Recording,
    palette: Palette,
    look: Look,
  ) {
    super();
    const shapes = new Map<string, GraphicsContext>();
    // The egos come first in a recording and are drawn above the others.
    this.drawn = recording.actors.toReversed().map((actor) => {
      const node = new Container();
      const colour = colourOfActor(actor, palette);
      const key = `${actor.role} ${colour} ${actor.length} ${actor.width}`;
      let shape = shapes.get(key);
      if (!shape) {
        shape = look === "whole" ? wholeShape(actor, colour, palette) : outlineShape(actor, colour);
        shapes.set(key, shape);
      }
      node.addChild(new Graphics(shape));
      const vehicle = actor.role !== "npc_walker" && actor.role !== "npc_obstacle";
      const whole = look === "whole";
      const brake = vehicle && whole ? brakeLights(actor, palette) : undefined;
      const ego = actor.role === "ego" && whole;
      const push = ego ? pushArrow(palette) : undefined;
      const wheels = ego ? frontWheels(actor, palette) : undefined;
      for (const part of [brake, push, wheels]) if (part) node.addChild(part);
      this.addChild(node);
      return { actor, node, brake, push, wheels };
    });
  }

  /** Moves the actors to a time, between two steps in proportion. */
  show(time: number, scale: number): void {
    const recording = this.recording;
    const count = recording.actors.length;
    const at = Math.min(time / recording.stepLength, recording.loaded - 1);
    const step = Math.floor(at + 1e-6);
    const next = Math.min(step + 1, recording.loaded - 1);
    const share = Math.max(at - step, 0);
    for (const { actor, node, brake, push, wheels } of this.drawn) {
      const here = step * count + actor.row;
      const x = recording.x[here] as number;
      if (step < 0 || Number.isNaN(x) || this.hidden.has(actor.row)) {
        node.visible = false;
        continue;
      }
      const there = next * count + actor.row;
      const y = recording.y[here] as number;
      const yaw = recording.yaw[here] as number;
      const x1 = recording.x[there] as number;
      node.visible = true;
      node.alpha = this.missed?.(step, actor.row) ? MISSED_ALPHA : 1;
      if (share > 0 && !Number.isNaN(x1)) {
        const turn = Math.sin((recording.yaw[there] as number) - yaw);
        node.position.set(x + share * (x1 - x), y + share * ((recording.y[there] as number) - y));
        node.rotation = yaw + share * Math.asin(turn);
      } else {
        node.position.set(x, y);
        node.rotation = yaw;
      }
      const least = actor.role === "npc_walker" ? SMALLEST_WALKER_PX : SMALLEST_PX;
      node.scale.set(Math.max(1, least / (Math.max(actor.width, 0.4) * scale)));
      if (brake) brake.visible = (recording.acceleration[here] as number) < BRAKING;
      if (push && wheels) {
        const ego = step * recording.egos + actor.row;
        const asked = recording.askedAcceleration[ego] as number;
        const steer = recording.steer[ego] as number;
        push.visible = Math.abs(asked) > 0.05;
        push.scale.x = asked * ARROW_M_PER_MPS2;
        wheels.visible = !Number.isNaN(steer);
        for (const wheel of wheels.children) wheel.rotation = steer || 0;
      }
    }
  }

  /** Returns the boxes around the actors on the screen as they were shown last, by row. */
  boxes(camera: Camera, size: Size): ReadonlyMap<number, PixelBox> {
    const boxes = new Map<number, PixelBox>();
    for (const { actor, node } of this.drawn) {
      if (!node.visible) continue;
      const px = camera.scale * node.scale.x;
      const cos = Math.abs(Math.cos(node.rotation));
      const sin = Math.abs(Math.sin(node.rotation));
      const width = (cos * actor.length + sin * actor.width) * px;
      const height = (sin * actor.length + cos * actor.width) * px;
      const [left, top] = toScreen(camera, size, node.x, node.y);
      boxes.set(actor.row, { left: left - width / 2, top: top - height / 2, width, height });
    }
    return boxes;
  }

  /** Returns the actor whose box holds a place at a time, or is nearest within some metres. */
  at(x: number, y: number, time: number, within: number): Actor | undefined {
    const recording = this.recording;
    const step = Math.min(Math.floor(time / recording.stepLength + 1e-6), recording.loaded - 1);
    const count = recording.actors.length;
    let best: Actor | undefined;
    let bestDistance = within;
    for (const { actor } of this.drawn) {
      const cell = step * count + actor.row;
      const ax = recording.x[cell];
      const ay = recording.y[cell];
      if (ax === undefined || ay === undefined || this.hidden.has(actor.row)) continue;
      const yaw = recording.yaw[cell] as number;
      const dx = x - ax;
      const dy = y - ay;
      const along = Math.abs(dx * Math.cos(yaw) + dy * Math.sin(yaw)) - 0.5 * actor.length;
      const across = Math.abs(dy * Math.cos(yaw) - dx * Math.sin(yaw)) - 0.5 * actor.width;
      const distance = Math.hypot(Math.max(along, 0), Math.max(across, 0));
      if (distance <= bestDistance) {
        best = actor;
        bestDistance = distance;
      }
    }
    return best;
  }
}

function outlineShape(actor: Actor, colour: number): GraphicsContext {
  const l = 0.5 * actor.length;
  const w = 0.5 * actor.width;
  const shape = new GraphicsContext();
  const style = { width: 0.22, color: colour };
  if (actor.role === "npc_walker") return shape.circle(0, 0, Math.max(l, w)).stroke(style);
  return shape
    .rect(-l, -w, 2 * l, 2 * w)
    .moveTo(0.55 * l, -w)
    .lineTo(l, 0)
    .lineTo(0.55 * l, w)
    .stroke(style);
}

function brakeLights(actor: Actor, palette: Palette): Graphics {
  const l = 0.5 * actor.length;
  const w = 0.5 * actor.width;
  const lights = new Graphics()
    .rect(-l - 0.12, -w + 0.1, 0.38, 0.5 * w)
    .rect(-l - 0.12, 0.5 * w - 0.1, 0.38, 0.5 * w)
    .fill(palette.lights.red);
  lights.visible = false;
  return lights;
}

/** An arrow of one metre: what the agent asks for stretches it ahead or back. */
function pushArrow(palette: Palette): Graphics {
  const arrow = new Graphics().rect(0, -0.14, 1, 0.28).fill({ color: palette.ink, alpha: 0.9 });
  arrow.visible = false;
  return arrow;
}

function frontWheels(actor: Actor, palette: Palette): Container {
  const wheels = new Container();
  for (const side of [-1, 1]) {
    const wheel = new Graphics().roundRect(-0.45, -0.14, 0.9, 0.28, 0.1).fill(palette.ink);
    wheel.position.set(0.3 * actor.length, side * 0.5 * actor.width);
    wheels.addChild(wheel);
  }
  return wheels;
}
