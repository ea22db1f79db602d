/** Colours of the map as numbers, read from the tokens of the theme. */
export interface Palette {
  readonly ground: number;
  readonly road: number;
  readonly kerb: number;
  readonly walk: number;
  readonly other: number;
  readonly mark: number;
  readonly arrow: number;
  readonly patch: number;
  readonly ink: number;
  readonly casing: number;
  readonly accent: number;
  readonly violation: number;
  readonly lost: number;
  readonly egos: readonly number[];
  readonly npc: number;
  readonly walker: number;
  readonly obstacle: number;
  readonly background: number;
  readonly lights: Readonly<Record<LightColour, number>>;
}

export type LightColour = "red" | "yellow" | "green" | "off";

const EGOS = 6;

/** Returns the colours of the theme that the document has now. */
export function paletteNow(): Palette {
  const style = getComputedStyle(document.documentElement);
  const read = (name: string) => colourNumber(style.getPropertyValue(`--${name}`));
  return {
    ground: read("map-ground"),
    road: read("map-road"),
    kerb: read("map-kerb"),
    walk: read("map-walk"),
    other: read("map-other"),
    mark: read("map-mark"),
    arrow: read("map-arrow"),
    patch: read("map-patch"),
    ink: read("map-ink"),
    casing: read("map-casing"),
    accent: read("accent"),
    violation: read("violation"),
    lost: read("lost"),
    egos: Array.from({ length: EGOS }, (_, ego) => read(`ego-${ego}`)),
    npc: read("npc"),
    walker: read("walker"),
    obstacle: read("obstacle"),
    background: read("map-arrow"),
    lights: {
      red: read("light-red"),
      yellow: read("light-yellow"),
      green: read("light-green"),
      off: read("light-off"),
    },
  };
}

/** Returns `#1f5fa8` as a number; builds also write `#fff`. */
export function colourNumber(text: string): number {
  const digits = text.trim().slice(1);
  const six = digits.length === 3 ? [...digits].map((digit) => digit + digit).join("") : digits;
  return Number.parseInt(six, 16);
}
