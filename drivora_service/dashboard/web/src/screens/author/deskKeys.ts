import type { KeyAction } from "../../shell/keys";
import type { AuthorMapHandle } from "./AuthorMap";
import { LISTS, type ListName, NOUNS } from "./scenario";
import type { Desk } from "./useDesk";

/** The keys that place something. */
export const PLACE_KEYS: Readonly<Record<ListName, string>> = {
  ego_vehicles: "e",
  npc_vehicles: "v",
  npc_walkers: "w",
  npc_obstacles: "o",
  friction_patches: "p",
};
const STEPS = [
  ["left", -1, 0],
  ["right", 1, 0],
  ["up", 0, 1],
  ["down", 0, -1],
] as const;
const NEAR_M = 0.5;
const FAR_M = 5;

/** Returns the words for one of a list. */
export function oneOf(list: ListName): string {
  const noun = NOUNS[list];
  return `${/^[eo]/.test(noun) ? "an" : "a"} ${noun}`;
}

/** Returns the keys of the desk. */
export function deskKeys(desk: Desk, map: () => AuthorMapHandle | null): readonly KeyAction[] {
  const placeAtMiddle = () => {
    const middle = map()?.middle(desk.tool);
    if (middle) desk.place(middle);
  };
  return [
    ...LISTS.map((list) => ({
      keys: PLACE_KEYS[list],
      does: `place ${oneOf(list)}`,
      run: () => desk.use({ kind: "add", list }),
    })),
    { keys: "space", does: "place at the middle of the map", run: placeAtMiddle },
    {
      keys: "enter",
      does: "place at the middle of the map; end a route",
      run: () => (desk.tool.kind === "add" ? placeAtMiddle() : desk.end()),
    },
    { keys: "escape", does: "end a route; choose nothing", run: desk.leave },
    { keys: "r", does: "extend the route of what is chosen", run: desk.extend },
    { keys: "d", does: "another of what is chosen", run: desk.copy },
    { keys: "delete", does: "remove what is chosen", run: () => desk.removeChosen() },
    ...STEPS.flatMap(([key, dx, dy]) => [
      {
        keys: key,
        does: `move what is chosen by ${NEAR_M} m`,
        run: () => desk.nudge(dx * NEAR_M, dy * NEAR_M),
      },
      {
        keys: `shift+${key}`,
        does: `move what is chosen by ${FAR_M} m`,
        run: () => desk.nudge(dx * FAR_M, dy * FAR_M),
      },
    ]),
    { keys: "u", does: "one step back", run: desk.draft.undo },
    { keys: "y", does: "one step forward again", run: desk.draft.redo },
    { keys: "f", does: "show the whole scenario", run: desk.fit },
    { keys: "x", does: "run it", run: desk.start },
    {
      keys: "t",
      does: "fields or text",
      run: () => desk.setSide(desk.side === "text" ? "fields" : "text"),
    },
  ];
}
