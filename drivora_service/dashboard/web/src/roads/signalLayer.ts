import { Container, Graphics } from "pixi.js";
import type { Schemas } from "../api/client";
import { flat, placeAt } from "./lines";
import type { LightColour, Palette } from "./palette";
import { colourOf } from "./signalColour";

type Geometry = Schemas["NetworkGeometry"];
type StopLine = Schemas["StopLineGeometry"];

const LINE_M = 0.35;
/** Red is the thickest bar and green the thinnest, so that the colour is not needed. */
const WIDTHS: Readonly<Record<LightColour, number>> = {
  red: 0.9,
  yellow: 0.65,
  green: 0.4,
  off: 0.35,
};
const LEFT_TO_RIGHT = "tTlLsRr";

/** Stop lines, signs, and the signals in the state that they have. */
export class SignalLayer extends Container {
  private readonly lights = new Map<string, { bars: Graphics; state: string }>();
  private readonly lines = new Map<string, StopLine[]>();
  private readonly crossings = new Map<string, Schemas["Crossing"][]>();

  constructor(
    geometry: Geometry,
    private readonly palette: Palette,
  ) {
    super();
    this.addChild(plainLines(geometry, palette), signs(geometry, palette));
    for (const line of geometry.stop_lines)
      if (line.light) this.lines.set(line.light, [...(this.lines.get(line.light) ?? []), line]);
    for (const crossing of geometry.crossings)
      if (crossing.light)
        this.crossings.set(crossing.light, [
          ...(this.crossings.get(crossing.light) ?? []),
          crossing,
        ]);
    for (const light of geometry.traffic_lights) {
      const bars = new Graphics();
      this.addChild(bars);
      this.lights.set(light.id, { bars, state: "?" });
      this.set(light.id, "");
    }
  }

  /** Shows a light in a state, SUMO's letter for each link; "" is unknown. */
  set(light: string, state: string): void {
    const shown = this.lights.get(light);
    if (!shown || shown.state === state) return;
    shown.state = state;
    shown.bars.clear();
    for (const line of this.lines.get(light) ?? []) this.drawLine(shown.bars, line, state);
    for (const crossing of this.crossings.get(light) ?? []) {
      const colour = colourOf(state[crossing.links[0] ?? -1]);
      const line = flat(crossing.shape);
      for (const end of [0, 1e9]) {
        const { x, y, heading } = placeAt(line, end);
        const nx = -Math.sin(heading) * 0.5 * crossing.width;
        const ny = Math.cos(heading) * 0.5 * crossing.width;
        shown.bars
          .moveTo(x + nx, y + ny)
          .lineTo(x - nx, y - ny)
          .stroke({ width: 0.6 * WIDTHS[colour], color: this.palette.lights[colour] });
      }
    }
  }

  /** One piece of the bar for each signal, in the order of its movements from left to right. */
  private drawLine(bars: Graphics, line: StopLine, state: string): void {
    const links = [...line.movements]
      .filter((movement) => movement.link >= 0)
      .sort((a, b) => LEFT_TO_RIGHT.indexOf(a.direction) - LEFT_TO_RIGHT.indexOf(b.direction));
    const [lx, ly, rx, ry] = flat(line.points) as [number, number, number, number];
    const count = Math.max(links.length, 1);
    for (let k = 0; k < count; k++) {
      const colour = colourOf(state[links[k]?.link ?? -1]);
      const from = (k + (k > 0 ? 0.06 : 0)) / count;
      const to = (k + (k < count - 1 ? 0.94 : 1)) / count;
      bars
        .moveTo(lx + (rx - lx) * from, ly + (ry - ly) * from)
        .lineTo(lx + (rx - lx) * to, ly + (ry - ly) * to)
        .stroke({ width: WIDTHS[colour], color: this.palette.lights[colour] });
    }
  }
}

function plainLines(geometry: Geometry, palette: Palette): Graphics {
  const found = new Graphics();
  for (const { points, light, control } of geometry.stop_lines) {
    if (light || control === "right_before_left" || control === "none") continue;
    const [lx, ly, rx, ry] = flat(points) as [number, number, number, number];
    if (control === "yield") {
      // Shark's teeth, as a give-way line is broken.
      for (let k = 0; k < 5; k++) {
        const a = (k + 0.15) / 5;
        const b = (k + 0.85) / 5;
        found
          .moveTo(lx + (rx - lx) * a, ly + (ry - ly) * a)
          .lineTo(lx + (rx - lx) * b, ly + (ry - ly) * b);
      }
    } else found.moveTo(lx, ly).lineTo(rx, ry);
  }
  return found.stroke({ width: LINE_M, color: palette.mark });
}

function signs(geometry: Geometry, palette: Palette): Graphics {
  const found = new Graphics();
  for (const { kind, position, heading } of geometry.signs) {
    const [x, y] = position as [number, number];
    const turned = (heading * Math.PI) / 180 - Math.PI / 2;
    if (kind === "yield") found.regularPoly(x, y, 1.0, 3, turned + Math.PI / 3);
    else found.regularPoly(x, y, 1.0, 8, turned + Math.PI / 8);
    found.fill(palette.casing).stroke({ width: 0.25, color: palette.lights.red });
  }
  return found;
}
