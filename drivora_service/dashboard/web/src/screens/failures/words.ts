import type { Schemas } from "../../api/client";
import type { MarkLook } from "../../components/Mark";

type Accountability = Schemas["Accountability"];

/** How it is shown that a failure counts, or why it does not. */
export const ACCOUNTABILITY: Readonly<Record<Accountability, MarkLook>> = {
  avoidable: { sign: "✕", tone: "bad", text: "at fault, avoidable" },
  unavoidable: { sign: "◐", tone: "lost", text: "at fault, not avoidable" },
  undetermined: { sign: "?", tone: "lost", text: "fault undetermined" },
  not_measurable: { sign: "?", tone: "lost", text: "at fault, avoidability not measurable" },
  not_judged: { sign: "◇", tone: "quiet", text: "fault not judged" },
  preventable: { sign: "◑", tone: "lost", text: "not at fault, but avoidable" },
  not_at_fault: { sign: "○", tone: "quiet", text: "not at fault" },
};

export const ACCOUNTABILITIES = Object.keys(ACCOUNTABILITY) as readonly Accountability[];

/** The parts of a kind of failure: `collision|road eb_1|npc_vehicle, front`. */
export interface KindWords {
  readonly oracle: string;
  readonly place: string;
  readonly relation: string;
}

export function wordsOfKind(kind: string): KindWords {
  const [oracle = "", place = "", relation = ""] = kind.split("|");
  return { oracle: plain(oracle), place, relation: plain(relation) };
}

/** Returns a name of the API as words: `red_light` as `red light`. */
export function plain(name: string): string {
  return name.replaceAll("_", " ");
}

/** Returns a kind on one line. */
export function kindText(kind: string): string {
  const { oracle, place, relation } = wordsOfKind(kind);
  return [oracle, relation, place].filter(Boolean).join(" · ");
}

/** Returns a group on one line: `collision|npc_vehicle, front|following`. */
export function groupText(group: string): string {
  return group.split("|").filter(Boolean).map(plain).join(" · ");
}
