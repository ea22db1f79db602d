import { type Ref, type RefObject, useEffect, useRef } from "react";
import { AuthorMap, type AuthorMapHandle } from "./AuthorMap";
import { oneOf, PLACE_KEYS } from "./deskKeys";
import { LISTS, NOUNS } from "./scenario";
import { SELECT, toolWords } from "./tool";
import type { Desk } from "./useDesk";

/** The map with the tools that place something on it. */
export function DeskMap({
  desk,
  map,
}: {
  readonly desk: Desk;
  readonly map: RefObject<AuthorMapHandle | null>;
}) {
  const { tool, actors, chosen } = desk;
  const { extent } = desk;
  const fitted = useRef(desk.camera.current !== undefined || actors.length === 0);
  useEffect(() => {
    // What was opened is shown as a whole, once.
    if (fitted.current || !extent || !map.current) return;
    fitted.current = map.current.fit(extent);
  });
  const id = actors.find(({ pointer }) => pointer === chosen.actor)?.id ?? "";
  return (
    <>
      <div className="author-tools" role="toolbar" aria-label="Place on the map">
        <button
          type="button"
          aria-pressed={tool.kind === "select"}
          onClick={() => desk.use(SELECT)}
          title="Choose and drag what is there (escape)"
        >
          Choose
        </button>
        {LISTS.map((list) => (
          <button
            key={list}
            type="button"
            aria-pressed={tool.kind !== "select" && tool.list === list}
            onClick={() => desk.use({ kind: "add", list })}
            title={`Place ${oneOf(list)} (${PLACE_KEYS[list]})`}
          >
            + {NOUNS[list]}
          </button>
        ))}
        <span className="quiet author-tool-words" role="status">
          {toolWords(tool, id)}
        </span>
        {tool.kind === "extend" && (
          <button type="button" onClick={desk.end}>
            End the route
          </button>
        )}
      </div>
      <AuthorMap
        ref={map as Ref<AuthorMapHandle>}
        geometry={desk.geometry}
        actors={actors}
        chosen={chosen}
        tool={tool}
        camera={desk.camera.current}
        onChoose={desk.choose}
        onPlace={desk.place}
        onMove={desk.move}
        onMoved={desk.moved}
        onCamera={(now) => {
          desk.camera.current = now;
        }}
      >
        <div className="buttons">
          <button type="button" onClick={() => map.current?.zoom(1.4)} aria-label="Nearer">
            +
          </button>
          <button type="button" onClick={() => map.current?.zoom(1 / 1.4)} aria-label="Farther">
            −
          </button>
          <button type="button" onClick={desk.fit} title="Show the whole scenario (f)">
            Fit
          </button>
        </div>
      </AuthorMap>
    </>
  );
}
