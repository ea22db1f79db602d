/** What the search field finds. */
export type FoundKind =
  | "run"
  | "batch"
  | "campaign"
  | "study"
  | "minimization"
  | "network"
  | "agent";

export interface Found {
  readonly kind: FoundKind;
  readonly id: string;
  /** What it is called; its id where it has no name. */
  readonly name: string;
  readonly note: string;
}

const MOST_OF_A_KIND = 6;

/** Returns how well an object matches: 3 its id or name, 2 a beginning, 1 a part, 0 not at all. */
export function matchOf({ id, name }: Found, text: string): number {
  const wanted = text.trim().toLowerCase();
  if (!wanted) return 0;
  const words = [id, name].map((word) => word.toLowerCase());
  if (words.includes(wanted)) return 3;
  if (words.some((word) => word.startsWith(wanted))) return 2;
  return words.some((word) => word.includes(wanted)) ? 1 : 0;
}

/** Returns the objects that match, the best first, few of each kind. */
export function matching(all: readonly Found[], text: string): readonly Found[] {
  const perKind = new Map<FoundKind, number>();
  return all
    .map((found) => ({ found, match: matchOf(found, text) }))
    .filter(({ match }) => match > 0)
    .toSorted((a, b) => b.match - a.match)
    .filter(({ found: { kind } }) => {
      const before = perKind.get(kind) ?? 0;
      perKind.set(kind, before + 1);
      return before < MOST_OF_A_KIND;
    })
    .map(({ found }) => found);
}

/**
 * Returns whether a text may be an id: 24 hexadecimal digits, and an evaluation's number or what
 * names a run of a minimisation.
 */
export function isId(text: string): boolean {
  return /^[0-9a-f]{24}(-\d+(-again)?|-[0-9a-f]{14}[rtoc])?$/.test(text.trim());
}
