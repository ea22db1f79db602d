import type { Json, PlacedProblem } from "../../components/fields/pointers";
import type { Catalogues } from "./catalogues";
import type { Draft, Kind } from "./draft";

/** What the parts of a form share. */
export interface Form {
  readonly kind: Kind;
  readonly catalogues: Catalogues;
  readonly draft: Draft;
  /** Sets a value of the settings; without one, what is the default stands there. */
  readonly set: (pointer: string, value: Json | undefined) => void;
  readonly change: (update: (draft: Draft) => Draft) => void;
  /** Returns the problems of a place; `inside` also those of what is in it. */
  readonly problemsOf: (
    pointer: string,
    options?: { readonly inside?: boolean },
  ) => readonly PlacedProblem[];
}
