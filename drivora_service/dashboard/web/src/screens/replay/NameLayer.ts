import { Container, Text } from "pixi.js";
import { colourOfActor } from "../../roads/actorShapes";
import type { Palette } from "../../roads/palette";
import { freest, type PixelBox, sidesOf } from "../../roads/signPlaces";
import type { Look } from "./actorLayer";
import type { Actor } from "./recording";

const GAP_PX = 3;

interface Name {
  readonly text: Text;
  readonly size: { readonly width: number; readonly height: number };
  /** The side where it was shown last. */
  side: number;
}

/** The names of actors beside them. */
export class NameLayer extends Container {
  private readonly names = new Map<number, Name>();
  private scaled = 0;

  constructor(
    private readonly palette: Palette,
    private readonly look: Look,
  ) {
    super();
  }

  /** Names an actor from now on. */
  add(actor: Actor): void {
    if (this.names.has(actor.row)) return;
    const text = new Text({
      text: this.look === "outline" ? `${actor.id} 2nd` : actor.id,
      style: {
        fontFamily: "sans-serif",
        fontSize: 11,
        fontWeight: "600",
        fill: colourOfActor(actor, this.palette),
        stroke: { color: this.palette.casing, width: 3, join: "round" },
      },
      resolution: 2,
    });
    text.anchor.set(0.5);
    const { width, height } = text;
    this.names.set(actor.row, { text, size: { width, height }, side: 0 });
    this.addChild(text);
  }

  /** Puts the names beside the boxes of their actors at a scale, and returns where they are. */
  show(boxes: ReadonlyMap<number, PixelBox>, scale: number): readonly PixelBox[] {
    // Another scale is another picture, in which the first side may be free again.
    if (scale !== this.scaled) for (const name of this.names.values()) name.side = 0;
    this.scaled = scale;
    const taken = [...boxes.values()];
    const shown: PixelBox[] = [];
    for (const [row, name] of this.names) {
      const box = boxes.get(row);
      name.text.visible = box !== undefined;
      if (!box) continue;
      const [above, below, right, left] = sidesOf(box, name.size, GAP_PX);
      // Below the outline of a second run, above those of the first: they may be at one place.
      const places =
        this.look === "outline" ? [below, right, left, above] : [above, below, right, left];
      name.side = freest(places, [...taken, ...shown], name.side);
      const place = places[name.side] ?? above;
      name.text.position.set(place.left + place.width / 2, place.top + place.height / 2);
      shown.push(place);
    }
    return shown;
  }
}
