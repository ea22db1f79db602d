import { Container, Graphics, Text } from "pixi.js";
import { type Camera, type Size, toScreen } from "./camera";
import type { Palette } from "./palette";

/** A line between two places with its length. */
export class Ruler extends Container {
  private readonly line = new Graphics();
  private readonly text: Text;
  private from: readonly [number, number] | undefined;
  private to: readonly [number, number] | undefined;
  private fixed = false;

  constructor(private readonly palette: Palette) {
    super();
    this.text = new Text({
      text: "",
      style: {
        fontFamily: "sans-serif",
        fontSize: 13,
        fontWeight: "600",
        fill: palette.ink,
        stroke: { color: palette.casing, width: 4, join: "round" },
      },
      resolution: 2,
    });
    this.text.anchor.set(0.5, 1.4);
    this.addChild(this.line, this.text);
  }

  /** Begins at a place, or ends there. */
  click(x: number, y: number): void {
    if (!this.from || this.fixed) {
      this.from = [x, y];
      this.to = undefined;
      this.fixed = false;
    } else {
      this.to = [x, y];
      this.fixed = true;
    }
  }

  /** Moves the end that is not yet set. */
  point(x: number, y: number): void {
    if (this.from && !this.fixed) this.to = [x, y];
  }

  clear(): void {
    this.from = undefined;
    this.to = undefined;
    this.fixed = false;
  }

  show(camera: Camera, size: Size): void {
    this.line.clear();
    this.text.visible = this.to !== undefined;
    if (!this.from) return;
    const [ax, ay] = toScreen(camera, size, ...this.from);
    const [bx, by] = this.to ? toScreen(camera, size, ...this.to) : [ax, ay];
    this.line
      .moveTo(ax, ay)
      .lineTo(bx, by)
      .stroke({ width: 4, color: this.palette.casing })
      .moveTo(ax, ay)
      .lineTo(bx, by)
      .stroke({ width: 1.6, color: this.palette.ink })
      .circle(ax, ay, 3)
      .circle(bx, by, 3)
      .fill(this.palette.ink);
    if (!this.to) return;
    const metres = Math.hypot(this.to[0] - this.from[0], this.to[1] - this.from[1]);
    this.text.text = `${metres.toFixed(2)} m`;
    this.text.position.set((ax + bx) / 2, (ay + by) / 2);
  }
}
