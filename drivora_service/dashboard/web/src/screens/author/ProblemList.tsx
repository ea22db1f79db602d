import type { Schemas } from "../../api/client";
import { isObject, type JsonObject, keysOf, valueAt } from "../../components/fields/pointers";
import { actorOf } from "./scenario";

/** Everything that is wrong, or worth knowing; a press goes to its place. */
export function ProblemList({
  scenario,
  inspection,
  unreadable,
  onGo,
}: {
  readonly scenario: JsonObject;
  readonly inspection: Schemas["Inspection"] | undefined;
  /** Why the text cannot be read; "" if it can. */
  readonly unreadable: string;
  readonly onGo: (pointer: string) => void;
}) {
  const problems = inspection?.problems ?? [];
  const notes = inspection?.notes ?? [];
  if (!unreadable && problems.length === 0 && notes.length === 0) return null;
  return (
    <section className="author-problems" aria-label="Problems and notes">
      <ul>
        {unreadable && <li className="problem">{unreadable} The map shows what was read last.</li>}
        {problems.map(({ pointer, code, message }) => (
          <li key={`${pointer} ${code} ${message}`}>
            <button type="button" className="plain" onClick={() => onGo(pointer)}>
              <span className="problem">✕ {placeWords(scenario, pointer)}</span> {message}
            </button>
          </li>
        ))}
        {notes.map((note) => (
          <li key={note} className="quiet">
            ○ {note}
          </li>
        ))}
      </ul>
    </section>
  );
}

/** Returns the words for a place of the document: the actor's id, and the rest of its pointer. */
export function placeWords(scenario: JsonObject, pointer: string): string {
  const actor = actorOf(pointer);
  if (!actor) return pointer === "" ? "scenario" : keysOf(pointer).join(" ").replaceAll("_", " ");
  const item = valueAt(scenario, actor);
  const id = isObject(item) && typeof item.id === "string" ? item.id : actor;
  const rest = keysOf(pointer.slice(actor.length));
  const [what, index, ...further] = rest;
  if (what === "route" && index !== undefined) return [id, `place ${index}`, ...further].join(" ");
  return [id, ...rest].join(" ").replaceAll("_", " ");
}
