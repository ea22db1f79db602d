import { GraphicsContext } from "pixi.js";
import type { Palette } from "./palette";

/** What an actor looks like. */
export interface ActorShape {
  readonly role: string;
  /** Metres. */
  readonly length: number;
  readonly width: number;
}

/** Returns the colour of an actor: egos in turn, others by their role. */
export function colourOfActor(
  actor: Pick<ActorShape, "role"> & { readonly row: number },
  palette: Palette,
): number {
  if (actor.role === "ego") return palette.egos[actor.row % palette.egos.length] ?? palette.npc;
  if (actor.role === "npc_walker") return palette.walker;
  if (actor.role === "npc_obstacle") return palette.obstacle;
  return palette.npc;
}

/** Returns an actor from above, its front to the east. */
export function wholeShape(actor: ActorShape, colour: number, palette: Palette): GraphicsContext {
  const l = 0.5 * actor.length;
  const w = 0.5 * actor.width;
  const shape = new GraphicsContext();
  const casing = { width: 0.16, color: palette.casing };
  if (actor.role === "npc_walker") {
    const r = Math.max(l, w);
    return shape
      .circle(0, 0, r)
      .fill(colour)
      .stroke({ width: 0.08, color: palette.casing })
      .moveTo(0, 0)
      .lineTo(2.2 * r, 0)
      .stroke({ width: 0.12, color: colour, cap: "round" });
  }
  if (actor.role === "npc_obstacle")
    return shape
      .rect(-l, -w, 2 * l, 2 * w)
      .fill(colour)
      .stroke({ width: 0.08, color: palette.casing })
      .moveTo(-l, -w)
      .lineTo(l, w)
      .moveTo(-l, w)
      .lineTo(l, -w)
      .stroke({ width: 0.07, color: palette.casing });
  shape
    .roundRect(-l, -w, 2 * l, 2 * w, Math.min(0.45, 0.4 * w))
    .fill({ color: colour, alpha: actor.role === "background" ? 0.55 : 1 })
    .stroke(casing);
  // The wind-screen points ahead; an ego has its whole front light as well.
  const screen = Math.min(0.28 * l, 0.8);
  shape
    .poly([
      0.42 * l,
      -0.72 * w,
      0.42 * l + screen,
      -0.86 * w,
      0.42 * l + screen,
      0.86 * w,
      0.42 * l,
      0.72 * w,
    ])
    .fill({ color: palette.casing, alpha: 0.75 });
  if (actor.role === "ego")
    shape
      .poly([-0.2 * l, -0.5 * w, 0.25 * l, 0, -0.2 * l, 0.5 * w])
      .fill({ color: palette.casing, alpha: 0.9 });
  return shape;
}
