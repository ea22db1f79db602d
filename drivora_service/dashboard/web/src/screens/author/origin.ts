import { isObject } from "../../components/fields/pointers";
import { labelled } from "../compose/draft";

const EDITED = ", edited";
const LONGEST = 100;

/** What a scenario was opened from. */
export interface Origin {
  /** The label of the run, the name of the file or of the example. */
  readonly label: string;
  /** The id of the run; "" of what is none. */
  readonly run: string;
}

/** Returns the words for a scenario that was opened from something, and perhaps edited. */
export function originWords({ label }: Origin, isEdited: boolean): string {
  if (!isEdited || label.endsWith(EDITED)) return labelled(label, LONGEST);
  return `${labelled(label, LONGEST - EDITED.length)}${EDITED}`;
}

/** Returns an origin that was stored; undefined of anything else. */
export function readOrigin(stored: unknown): Origin | undefined {
  if (!isObject(stored)) return undefined;
  const { label, run } = stored;
  if (typeof label !== "string" || label === "") return undefined;
  return { label, run: typeof run === "string" ? run : "" };
}
