import { Graphics } from "pixi.js";
import { outlineOf, type Rectangle } from "./boxes";
import { dashes } from "./lines";
import type { Palette } from "./palette";
import { trace } from "./roadLayer";

const EDGE_M = 0.25;
/** Of a road of coefficient 1 a patch hides nothing, of 0 half. */
const MOST_COVER = 0.5;

/** A slippery rectangle of the road; its friction is a coefficient. */
export interface Patch extends Rectangle {
  readonly friction: number;
}

/** Draws slippery patches: the less friction, the more they cover the road. */
export function patchLayer(patches: readonly Patch[], palette: Palette): Graphics {
  const layer = new Graphics();
  for (const patch of patches) {
    const outline = outlineOf(patch);
    layer.poly(outline).fill({ color: palette.patch, alpha: MOST_COVER * (1 - patch.friction) });
    for (const dash of dashes([...outline, ...outline.slice(0, 2)], 0.8, 0.6)) trace(layer, dash);
    layer.stroke({ width: EDGE_M, color: palette.patch });
  }
  return layer;
}
