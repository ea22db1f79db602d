import { Container, Graphics } from "pixi.js";
import type { Schemas } from "../api/client";
import { beside, dashes, type FlatLine, flat, lengthOf, placeAt } from "./lines";
import type { Palette } from "./palette";

type Geometry = Schemas["NetworkGeometry"];
type Lane = Schemas["LaneGeometry"];

const DASH_M = 3;
const DASH_GAP_M = 5;
const MARK_M = 0.14;
const KERB_M = 0.25;
const ARROW_EVERY_M = 45;
const STRIPE_M = 0.5;
const MARKS_FROM_SCALE = 1.6;
const ARROWS_FROM_SCALE = 2.4;

/** The unmoving part of a network, drawn once: surfaces, markings, crossings, directions. */
export class RoadLayer extends Container {
  private readonly marks = new Graphics();
  private readonly arrows = new Graphics();

  constructor(geometry: Geometry, palette: Palette) {
    super();
    const lines = new Map(geometry.lanes.map((lane) => [lane, flat(lane.shape)]));
    this.addChild(
      surfaces(geometry, lines, palette),
      crossings(geometry, palette),
      this.marks,
      this.arrows,
    );
    markings(this.marks, lines, palette);
    arrows(this.arrows, lines, palette);
  }

  /** Leaves out what is too small to be read. */
  show(scale: number): void {
    this.marks.visible = scale >= MARKS_FROM_SCALE;
    this.arrows.visible = scale >= ARROWS_FROM_SCALE;
  }
}

export function trace(graphics: Graphics, line: FlatLine): void {
  for (let i = 0; i + 1 < line.length; i += 2) {
    const x = line[i] ?? 0;
    const y = line[i + 1] ?? 0;
    if (i === 0) graphics.moveTo(x, y);
    else graphics.lineTo(x, y);
  }
}

function surfaces(
  geometry: Geometry,
  lines: ReadonlyMap<Lane, FlatLine>,
  palette: Palette,
): Graphics {
  const ground = new Graphics();
  const areas = geometry.lanes.filter((lane) => lane.kind === "walking_area");
  const outlines = Object.values(geometry.junctions).filter((outline) => outline.length > 2);
  const road = (lane: Lane) => lane.kind === "road" || lane.kind === "junction";
  const strips = (wanted: (lane: Lane) => boolean, colour: number, wider: number) => {
    const byWidth = new Map<number, FlatLine[]>();
    for (const [lane, line] of lines) {
      if (!wanted(lane)) continue;
      const width = Math.max(lane.width + wider, 0.3);
      byWidth.set(width, [...(byWidth.get(width) ?? []), line]);
    }
    for (const [width, found] of byWidth) {
      for (const line of found) trace(ground, line);
      ground.stroke({ width, color: colour, cap: "butt", join: "round" });
    }
  };
  strips((lane) => lane.kind === "other", palette.other, 0);
  strips((lane) => lane.kind === "sidewalk", palette.walk, 0);
  for (const lane of areas) if (lane.shape.length > 2) ground.poly(flat(lane.shape));
  if (areas.length) ground.fill(palette.walk);
  // The kerb is what is left to see of a wider road below the road.
  for (const outline of outlines) ground.poly(flat(outline));
  if (outlines.length)
    ground.stroke({ width: 2 * KERB_M, color: palette.kerb, join: "round", alignment: 0.5 });
  strips(road, palette.kerb, 2 * KERB_M);
  for (const outline of outlines) ground.poly(flat(outline));
  if (outlines.length) ground.fill(palette.road);
  strips(road, palette.road, 0.06);
  return ground;
}

function crossings(geometry: Geometry, palette: Palette): Graphics {
  const found = new Graphics();
  for (const crossing of geometry.crossings) {
    const line = flat(crossing.shape);
    const half = 0.5 * crossing.width - 0.2;
    for (let s = STRIPE_M / 2; s + STRIPE_M <= lengthOf(line); s += 2 * STRIPE_M) {
      const { x, y, heading } = placeAt(line, s + STRIPE_M / 2);
      const nx = -Math.sin(heading) * half;
      const ny = Math.cos(heading) * half;
      found.moveTo(x + nx, y + ny).lineTo(x - nx, y - ny);
    }
  }
  return found.stroke({ width: STRIPE_M, color: palette.mark, cap: "butt" });
}

function markings(graphics: Graphics, lines: ReadonlyMap<Lane, FlatLine>, palette: Palette): void {
  const thick: FlatLine[] = [];
  for (const [lane, line] of lines) {
    for (const [marking, side] of [
      [lane.left_marking, 1],
      [lane.right_marking, -1],
    ] as const) {
      if (marking === "none" || marking === "edge") continue;
      // A line between two lanes of a direction is drawn once, as the left one's right border.
      if (side === 1 && (marking === "broken" || marking === "solid")) continue;
      const border = beside(line, side * 0.5 * lane.width);
      if (marking === "centre") thick.push(border);
      else if (marking === "solid") trace(graphics, border);
      else for (const dash of dashes(border, DASH_M, DASH_GAP_M)) trace(graphics, dash);
    }
  }
  graphics.stroke({ width: MARK_M, color: palette.mark });
  for (const line of thick) trace(graphics, line);
  if (thick.length) graphics.stroke({ width: 1.6 * MARK_M, color: palette.mark });
}

function arrows(graphics: Graphics, lines: ReadonlyMap<Lane, FlatLine>, palette: Palette): void {
  for (const [lane, line] of lines) {
    if (lane.kind !== "road" || !lane.drivable) continue;
    const whole = lengthOf(line);
    const count = Math.max(1, Math.floor(whole / ARROW_EVERY_M));
    if (whole < 12) continue;
    for (let k = 0; k < count; k++) {
      const { x, y, heading } = placeAt(line, ((k + 0.5) / count) * whole);
      const cos = Math.cos(heading);
      const sin = Math.sin(heading);
      const at = (along: number, across: number): [number, number] => [
        x + along * cos - across * sin,
        y + along * sin + across * cos,
      ];
      graphics
        .moveTo(...at(-1.2, 0.55))
        .lineTo(...at(0, 0))
        .lineTo(...at(-1.2, -0.55));
    }
  }
  graphics.stroke({ width: 0.18, color: palette.arrow, cap: "round", join: "round" });
}
