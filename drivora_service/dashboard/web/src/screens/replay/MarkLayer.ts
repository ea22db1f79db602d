import { Container, Graphics, Text } from "pixi.js";
import type { Schemas } from "../../api/client";
import { type Camera, type Size, toScreen } from "../../roads/camera";
import type { Palette } from "../../roads/palette";
import { freest, type PixelBox } from "../../roads/signPlaces";
import { toneOf } from "./verdictWords";

type Violation = Schemas["ViolationMark"];

const RADIUS_PX = 8;
const CROSS_PX = 3.5;
const NEAR_S = 2;
/** With more marks than this, those of other moments have no number. */
const MOST_NUMBERED = 6;

/** Where a number may stand from its place: beside it, or farther off where actors are in the way. */
const AWAY: readonly (readonly [number, number])[] = [26, 44].flatMap((far) =>
  (
    [
      [0.7, -0.7],
      [-0.7, -0.7],
      [0.7, 0.7],
      [-0.7, 0.7],
      [0, -1],
      [0, 1],
      [1, 0],
      [-1, 0],
    ] as const
  ).map(([right, down]) => [right * far, down * far] as const),
);

interface Mark {
  readonly node: Container;
  /** The number, and what joins it to the place. */
  readonly numbered: Container;
  readonly badge: Container;
  readonly leader: Graphics;
  readonly colour: number;
  readonly x: number;
  readonly y: number;
  readonly time: number;
  away: number;
}

/** Violations where they happened, with their numbers beside the actors. */
export class MarkLayer extends Container {
  private readonly marks: Mark[] = [];
  private scaled = 0;

  constructor(private readonly palette: Palette) {
    super();
  }

  /** Shows other violations than before. */
  set(violations: readonly Violation[], stepLength: number): void {
    for (const { node } of this.marks) node.destroy({ children: true });
    this.marks.length = 0;
    const palette = this.palette;
    const colours = { bad: palette.violation, lost: palette.lost, quiet: palette.npc };
    for (const violation of violations) {
      const { number, location, first } = violation;
      if (!location) continue;
      const [x, y] = location as [number, number];
      const colour = colours[toneOf(violation)];
      const node = new Container();
      const cross = new Graphics()
        .moveTo(-CROSS_PX, -CROSS_PX)
        .lineTo(CROSS_PX, CROSS_PX)
        .moveTo(-CROSS_PX, CROSS_PX)
        .lineTo(CROSS_PX, -CROSS_PX)
        .stroke({ width: 2, color: colour });
      const text = new Text({
        text: String(number),
        style: { fontFamily: "sans-serif", fontSize: 10, fontWeight: "600", fill: palette.casing },
        resolution: 2,
      });
      text.anchor.set(0.5);
      const badge = new Container();
      const disc = new Graphics()
        .circle(0, 0, RADIUS_PX)
        .fill(colour)
        .stroke({ width: 1.2, color: palette.casing });
      badge.addChild(disc, text);
      const leader = new Graphics();
      const numbered = new Container();
      numbered.addChild(leader, badge);
      node.addChild(cross, numbered);
      this.addChild(node);
      const time = (first ?? 0) * stepLength;
      this.marks.push({ node, numbered, badge, leader, colour, x, y, time, away: -1 });
    }
  }

  /** Shows the marks at a time; their numbers keep clear of what is taken already. */
  show(time: number, camera: Camera, size: Size, taken: readonly PixelBox[]): void {
    const few = this.marks.length <= MOST_NUMBERED;
    const inTheWay = [...taken];
    const isScaled = camera.scale !== this.scaled;
    this.scaled = camera.scale;
    for (const mark of this.marks) {
      // Marks of other moments stay in the background.
      const near = Math.abs(time - mark.time) < NEAR_S;
      mark.node.alpha = near ? 1 : 0.4;
      mark.numbered.visible = near || few;
      const [left, top] = toScreen(camera, size, mark.x, mark.y);
      mark.node.position.set(left, top);
      if (!mark.numbered.visible) continue;
      const places = AWAY.map(([right, down]) => around(left + right, top + down));
      const away = freest(places, inTheWay, isScaled ? -1 : mark.away);
      if (away !== mark.away) lead(mark, away);
      const place = places[away];
      if (place) inTheWay.push(place);
    }
  }
}

function around(left: number, top: number): PixelBox {
  const side = 2 * RADIUS_PX + 2;
  return { left: left - side / 2, top: top - side / 2, width: side, height: side };
}

/** Puts the number of a mark to another place, with a line to where the violation was. */
function lead(mark: Mark, away: number): void {
  const [right, down] = AWAY[away] ?? [0, 0];
  mark.away = away;
  mark.badge.position.set(right, down);
  mark.leader.clear().moveTo(0, 0).lineTo(right, down).stroke({ width: 1.2, color: mark.colour });
}
