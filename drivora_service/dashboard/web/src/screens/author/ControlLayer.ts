import { Container, Graphics } from "pixi.js";
import type { Schemas } from "../../api/client";
import { flat } from "../../roads/lines";
import type { DrawnMap } from "../../roads/RoadMap";

type Geometry = Schemas["NetworkGeometry"];

const LINE_PX = 3;
const LINE_M = 0.5;
const SIGN_PX = 6;
const SIGN_M = 1.3;
const ICON_PX = 18;
/** How far from the icon of a light the pointer still names it. */
const NEAR_PX = 12;
const DOTS = [-1, 0, 1];

/**
 * How the junctions are controlled: an icon at each traffic light, the stop lines of its lanes, and
 * the signs, none of them too small to be seen. No run tells the state of a light, so all of them
 * have one neutral colour.
 */
export class ControlLayer extends Container {
  private readonly lines = new Graphics();
  private readonly marks: { readonly node: Container; readonly metres: number }[] = [];
  private readonly stopLines: readonly (readonly number[])[];
  private drawnFor = 0;

  constructor(
    private readonly geometry: Geometry,
    private readonly palette: DrawnMap["palette"],
  ) {
    super();
    this.addChild(this.lines);
    this.stopLines = geometry.stop_lines
      .filter(({ light }) => light)
      .map(({ points }) => flat(points));
    for (const sign of geometry.signs) {
      const [x, y] = sign.position as [number, number];
      this.add(this.signOf(sign), x, y, SIGN_M);
    }
    for (const { position } of geometry.traffic_lights) {
      const [x, y] = position as [number, number];
      this.add(this.iconOf(), x, y, 0);
    }
  }

  /** Draws what keeps a least size on the screen for a scale, pixels a metre. */
  show(scale: number): void {
    if (scale === this.drawnFor) return;
    this.drawnFor = scale;
    for (const { node, metres } of this.marks)
      node.scale.set(metres > 0 ? Math.max(metres, SIGN_PX / scale) : 1 / scale);
    this.lines.clear();
    for (const [lx = 0, ly = 0, rx = 0, ry = 0] of this.stopLines)
      this.lines.moveTo(lx, ly).lineTo(rx, ry);
    if (this.stopLines.length > 0)
      this.lines.stroke({ width: Math.max(LINE_M, LINE_PX / scale), color: this.palette.ink });
  }

  /** Returns the words for the light whose icon is at a place; "" for none. */
  nameAt(x: number, y: number): string {
    const reach = NEAR_PX / Math.max(this.drawnFor, 1e-6);
    const found = this.geometry.traffic_lights.find(({ position: [lx = 0, ly = 0] }) => {
      return Math.hypot(lx - x, ly - y) < reach;
    });
    return found ? `traffic light ${found.id}` : "";
  }

  private add(node: Container, x: number, y: number, metres: number): void {
    node.position.set(x, y);
    this.marks.push({ node, metres });
    this.addChild(node);
  }

  /** A sign of the radius 1. */
  private signOf({ kind, heading }: Geometry["signs"][number]): Graphics {
    const turned = (heading * Math.PI) / 180 - Math.PI / 2;
    const found = new Graphics();
    if (kind === "yield") found.regularPoly(0, 0, 1, 3, turned + Math.PI / 3);
    else found.regularPoly(0, 0, 1, 8, turned + Math.PI / 8);
    return found.fill(this.palette.casing).stroke({ width: 0.3, color: this.palette.lights.red });
  }

  /** A light of three lamps, in pixels. */
  private iconOf(): Graphics {
    const { ink, casing } = this.palette;
    const found = new Graphics()
      .roundRect(-ICON_PX / 4, -ICON_PX / 2, ICON_PX / 2, ICON_PX, 3)
      .fill(ink)
      .stroke({ width: 1.5, color: casing });
    for (const dot of DOTS) found.circle(0, (dot * ICON_PX) / 3.4, 2).fill(casing);
    return found;
  }
}
