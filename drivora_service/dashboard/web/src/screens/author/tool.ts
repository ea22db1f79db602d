import type { ListName } from "./scenario";

/** What a click on the map does. */
export type Tool =
  | { readonly kind: "select" }
  /** Places a new actor. */
  | { readonly kind: "add"; readonly list: ListName }
  /** Goes on with the route of an actor. */
  | { readonly kind: "extend"; readonly list: ListName; readonly actor: string };

export const SELECT: Tool = { kind: "select" };

/** Whether actors of a list have a route. */
export function hasRoute(list: ListName): boolean {
  return list !== "npc_obstacles" && list !== "friction_patches";
}

/** Returns what the reader is told while a tool is used. */
export function toolWords(tool: Tool, id: string): string {
  switch (tool.kind) {
    case "select":
      return "";
    case "add":
      return hasRoute(tool.list)
        ? "Click where it starts, then its way. Alt places it beside the lane."
        : "Click where it stands.";
    case "extend":
      return `Click the way of ${id || "the actor"}, place by place. Enter ends it.`;
  }
}
