import { Container, Graphics } from "pixi.js";
import type { Palette } from "../../roads/palette";
import type { PerceivedActors } from "./perception";
import type { Recording } from "./recording";

/** Where an ego perceives the others, as outlines beside the true ones, and how far it sees. */
export class PerceptionLayer extends Container {
  private readonly outlines: readonly Graphics[];
  private readonly range = new Graphics();

  constructor(
    private readonly recording: Recording,
    private readonly perceived: PerceivedActors,
    palette: Palette,
  ) {
    super();
    const { row, sensor } = perceived.head;
    const colour = palette.egos[row % palette.egos.length] ?? palette.ink;
    if (sensor.range !== null)
      this.range
        .circle(0, 0, sensor.range)
        .fill({ color: colour, alpha: 0.05 })
        .circle(0, 0, sensor.range)
        .stroke({ color: colour, alpha: 0.6, pixelLine: true });
    this.outlines = recording.actors.map(({ length, width }) =>
      new Graphics()
        .rect(-0.5 * length, -0.5 * width, length, width)
        .moveTo(0.2 * length, -0.5 * width)
        .lineTo(0.5 * length, 0)
        .lineTo(0.2 * length, 0.5 * width)
        .stroke({ width: 0.2, color: colour }),
    );
    this.addChild(this.range, ...this.outlines);
  }

  /** Shows a step. */
  show(step: number): void {
    const perceived = this.perceived;
    const recording = this.recording;
    const ego = step * recording.actors.length + perceived.head.row;
    const x = recording.x[ego] as number;
    this.range.visible = !Number.isNaN(x);
    if (this.range.visible) this.range.position.set(x, recording.y[ego] as number);
    for (let row = 0; row < this.outlines.length; row++) {
      const outline = this.outlines[row];
      if (!outline) continue;
      outline.visible = perceived.isPerceived(step, row);
      if (!outline.visible) continue;
      const cell = step * perceived.actors + row;
      outline.position.set(perceived.x[cell] as number, perceived.y[cell] as number);
      outline.rotation = perceived.yaw[cell] as number;
    }
  }
}
