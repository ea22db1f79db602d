import { Graphics } from "pixi.js";
import type { Palette } from "../../roads/palette";
import { trace } from "../../roads/roadLayer";
import type { AgentTold, Plan } from "./plans";

/** The paths that the agents plan at a step; drawn anew only when a plan has changed. */
export class PlanLayer extends Graphics {
  private readonly shown: (Plan | undefined)[];

  constructor(
    readonly told: AgentTold,
    private readonly egos: number,
    private readonly palette: Palette,
  ) {
    super();
    this.shown = Array.from({ length: egos });
  }

  show(step: number, hidden: ReadonlySet<number>): void {
    let changed = false;
    for (let ego = 0; ego < this.egos; ego++) {
      const plan = hidden.has(ego) ? undefined : this.told.planAt(ego, step);
      if (plan === this.shown[ego]) continue;
      this.shown[ego] = plan;
      changed = true;
    }
    if (!changed) return;
    this.clear();
    this.shown.forEach((plan, ego) => {
      if (!plan) return;
      const color = this.palette.egos[ego % this.palette.egos.length] ?? this.palette.ink;
      const line = Array.from(plan.points);
      trace(this, line);
      this.stroke({ width: 0.9, color: this.palette.casing, alpha: 0.6, cap: "round" });
      trace(this, line);
      this.stroke({ width: 0.5, color, cap: "round" });
      const [x, y] = line.slice(-2) as [number, number];
      this.circle(x, y, 0.5).fill(color);
    });
  }
}
