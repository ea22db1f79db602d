import { isObject, type JsonObject, keysOf, valueAt } from "../../components/fields/pointers";
import { actorOf, listNameOf, NOUNS } from "./scenario";

/** Returns the words for a place of the document: the actor's id, and the rest of its pointer. */
export function placeWords(scenario: JsonObject, pointer: string): string {
  const actor = actorOf(pointer);
  if (!actor) return pointer === "" ? "scenario" : keysOf(pointer).join(" ").replaceAll("_", " ");
  const item = valueAt(scenario, actor);
  const id = isObject(item) && typeof item.id === "string" ? item.id : numbered(actor);
  const rest = keysOf(pointer.slice(actor.length)).map((key) => key.replaceAll("_", " "));
  const [what, index, ...further] = rest;
  if (what === "route" && index !== undefined) return [id, `place ${index}`, ...further].join(" ");
  return [id, ...rest].join(" ");
}

function numbered(actor: string): string {
  const list = listNameOf(actor);
  return `${list ? NOUNS[list] : "actor"} ${keysOf(actor)[1]}`;
}
