import type { Json, JsonObject, PlacedProblem } from "../../components/fields/pointers";
import { problemsAt } from "../../components/fields/pointers";

/** What every part of the screen that edits the scenario is handed. */
export interface Editing {
  readonly scenario: JsonObject;
  readonly problems: readonly PlacedProblem[];
  /** Sets a value of the document; `undefined` removes it. */
  readonly set: (pointer: string, value: Json | undefined) => void;
}

/** Returns the problems of one field. */
export function problemsOf(editing: Editing): (pointer: string) => readonly PlacedProblem[] {
  return (pointer) => problemsAt(editing.problems, pointer, { inside: true });
}
