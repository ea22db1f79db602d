import type { Schemas } from "../../api/client";
import type { JsonObject } from "../../components/fields/pointers";
import { fixed } from "../../components/numbers";
import { placeOfNote } from "./placeOfNote";
import { placeWords } from "./placeWords";
import { noActorYet } from "./scenario";
import type { ShownActor } from "./shownActors";

/** Everything that is wrong, or worth knowing; a press goes to its place. */
export function ProblemList({
  scenario,
  inspection,
  unreadable,
  detours,
  onGo,
}: {
  readonly scenario: JsonObject;
  readonly inspection: Schemas["Inspection"] | undefined;
  /** Why the text cannot be read; "" if it can. */
  readonly unreadable: string;
  /** Actors whose way is much longer than their route. */
  readonly detours: readonly ShownActor[];
  readonly onGo: (pointer: string) => void;
}) {
  const problems = inspection?.problems ?? [];
  const notes = inspection?.notes ?? [];
  const isEmpty = !unreadable && problems.length + notes.length + detours.length === 0;
  return (
    <section className="author-problems" aria-label="Problems and notes">
      <ul>
        {isEmpty && (
          <li className="quiet">{inspection ? "No problems, no notes" : "Being checked"}</li>
        )}
        {unreadable && <li className="problem">{unreadable} The map shows what was read last.</li>}
        {problems.map(({ pointer, code, message }) => (
          <li key={`${pointer} ${code} ${message}`}>
            <button type="button" className="plain problem" onClick={() => onGo(pointer)}>
              <span>
                <strong>{placeWords(scenario, pointer)}:</strong> {message}
                {noActorYet(scenario, pointer) && (
                  <span className="author-jump"> Place one on the map</span>
                )}
              </span>
            </button>
          </li>
        ))}
        {detours.map(({ pointer, id, pathLength }) => (
          <li key={pointer}>
            <button type="button" className="plain" onClick={() => onGo(pointer)}>
              <span>
                ○ <strong>{id}</strong> takes a detour: its way is {fixed(pathLength, 0)} m long,
                much longer than the distances between its places
              </span>
            </button>
          </li>
        ))}
        {notes.map((note) => (
          <li key={note} className="quiet">
            <Note note={note} scenario={scenario} onGo={onGo} />
          </li>
        ))}
      </ul>
    </section>
  );
}

/** A remark of the validation; a press goes to its place, if it has one. */
function Note({
  note,
  scenario,
  onGo,
}: {
  readonly note: string;
  readonly scenario: JsonObject;
  readonly onGo: (pointer: string) => void;
}) {
  const { pointer, words } = placeOfNote(note);
  if (pointer === "") return <>○ {words}</>;
  return (
    <button type="button" className="plain quiet" onClick={() => onGo(pointer)}>
      <span>
        ○ <strong>{placeWords(scenario, pointer)}:</strong> {words}
      </span>
    </button>
  );
}
