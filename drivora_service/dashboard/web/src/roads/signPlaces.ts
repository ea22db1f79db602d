/** A rectangle on the screen, pixels. */
export interface PixelBox {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
}

/**
 * Returns which of several places for a sign covers the least of what is in the way, the earlier of
 * two alike. The place before is kept while it is free, so that signs do not jump.
 */
export function freest(
  places: readonly PixelBox[],
  taken: readonly PixelBox[],
  before: number,
): number {
  const covers = (place: PixelBox) => taken.reduce((sum, other) => sum + common(place, other), 0);
  const kept = places[before];
  if (kept && covers(kept) === 0) return before;
  let best = 0;
  let least = Number.POSITIVE_INFINITY;
  for (const [number, place] of places.entries()) {
    const covered = covers(place);
    if (covered >= least) continue;
    best = number;
    least = covered;
    if (covered === 0) break;
  }
  return best;
}

/** Returns the places for a sign around a box: above, below, to the right and to the left. */
export function sidesOf(
  box: PixelBox,
  sign: Pick<PixelBox, "width" | "height">,
  gap: number,
): readonly [PixelBox, PixelBox, PixelBox, PixelBox] {
  const left = box.left + (box.width - sign.width) / 2;
  const top = box.top + (box.height - sign.height) / 2;
  const { width, height } = sign;
  return [
    { left, top: box.top - gap - height, width, height },
    { left, top: box.top + box.height + gap, width, height },
    { left: box.left + box.width + gap, top, width, height },
    { left: box.left - gap - width, top, width, height },
  ];
}

function common(a: PixelBox, b: PixelBox): number {
  const across = Math.min(a.left + a.width, b.left + b.width) - Math.max(a.left, b.left);
  const along = Math.min(a.top + a.height, b.top + b.height) - Math.max(a.top, b.top);
  return across > 0 && along > 0 ? across * along : 0;
}
