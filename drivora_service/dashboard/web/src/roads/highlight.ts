import { Graphics } from "pixi.js";
import type { LaneIndex } from "./laneIndex";
import { type FlatLine, flat } from "./lines";
import { trace } from "./roadLayer";

/** Lanes that are pointed at or chosen. */
export class Highlight extends Graphics {
  private shown = "";

  constructor(
    private readonly index: LaneIndex,
    private readonly colour: number,
    private readonly strength: number,
  ) {
    super();
  }

  /** Shows lanes by their ids, and an outline; returns whether that changes anything. */
  show(lanes: readonly string[], outline: readonly (readonly number[])[] = []): boolean {
    const shown = `${lanes.join(" ")} ${outline.length}`;
    if (shown === this.shown) return false;
    this.shown = shown;
    this.clear();
    for (const id of lanes) {
      const lane = this.index.byId.get(id);
      if (!lane) continue;
      const line: FlatLine = this.index.lineOf(lane);
      const style = { color: this.colour, alpha: this.strength };
      if (lane.kind === "walking_area" && line.length > 4) this.poly([...line]).fill(style);
      else {
        trace(this, line);
        this.stroke({ ...style, width: Math.max(lane.width - 0.4, 0.4) });
      }
    }
    if (outline.length > 2)
      this.poly(flat(outline)).fill({ color: this.colour, alpha: this.strength });
    return true;
  }
}
