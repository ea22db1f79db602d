import type { Schemas } from "../../../api/client";

type Kind = Schemas["ScenarioKind"];

export const TURNS = ["straight", "left", "right", "back", "unknown"] as const;
export const OTHERS = ["vehicles", "walkers", "obstacles", "egos", "none"] as const;

/** Kinds of scenarios: a row for each turn, a column for each kind of other actors. */
export interface KindTable {
  readonly turns: readonly Kind["turn"][];
  readonly others: readonly Kind["others"][];
  readonly at: (turn: Kind["turn"], others: Kind["others"]) => Kind | undefined;
}

/** Returns the kinds as a table of the turns and the other actors that occur. */
export function kindTable(kinds: readonly Kind[]): KindTable {
  return {
    turns: TURNS.filter((turn) => kinds.some((kind) => kind.turn === turn)),
    others: OTHERS.filter((others) => kinds.some((kind) => kind.others === others)),
    at: (turn, others) => kinds.find((kind) => kind.turn === turn && kind.others === others),
  };
}
