import { Graphics } from "pixi.js";
import { dashes } from "../../roads/lines";
import type { Palette } from "../../roads/palette";
import { trace } from "../../roads/roadLayer";
import { outlineOf } from "./patches";
import type { FrictionPatch } from "./recording";

const EDGE_M = 0.25;
/** Of a road of coefficient 1 a patch hides nothing, of 0 half. */
const MOST_COVER = 0.5;

/** Draws slippery patches: the less friction, the more they cover the road. */
export function patchLayer(patches: readonly FrictionPatch[], palette: Palette): Graphics {
  const layer = new Graphics();
  for (const patch of patches) {
    const outline = outlineOf(patch);
    layer.poly(outline).fill({ color: palette.patch, alpha: MOST_COVER * (1 - patch.friction) });
    for (const dash of dashes([...outline, ...outline.slice(0, 2)], 0.8, 0.6)) trace(layer, dash);
    layer.stroke({ width: EDGE_M, color: palette.patch });
  }
  return layer;
}
