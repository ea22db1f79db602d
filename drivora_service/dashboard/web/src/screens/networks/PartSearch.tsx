import { useRef, useState } from "react";
import type { Schemas } from "../../api/client";
import { useKeys } from "../../shell/keys";
import { type Part, partsNamed } from "./search";

/** Finds lanes, edges, junctions, streets and lights of a network by their names. */
export function PartSearch({
  geometry,
  chosen,
  onChoose,
}: {
  readonly geometry: Schemas["NetworkGeometry"];
  readonly chosen: Part | undefined;
  readonly onChoose: (part: Part) => void;
}) {
  const [text, setText] = useState("");
  const field = useRef<HTMLInputElement>(null);
  useKeys([{ keys: "/", does: "search the network", run: () => field.current?.focus() }]);
  const found = partsNamed(geometry, text);
  return (
    <section className="panel" aria-label="Search">
      <div className="inside">
        <input
          ref={field}
          type="search"
          className="wide"
          placeholder="Lane, edge, junction, street, light"
          aria-label="Search the network"
          value={text}
          onChange={(event) => setText(event.target.value)}
          onKeyDown={(event) => {
            if (event.key === "Enter" && found[0]) onChoose(found[0]);
            if (event.key === "Escape") event.currentTarget.blur();
          }}
        />
        {text && (
          <ul className="found">
            {found.length === 0 && <li className="quiet">Nothing has this name.</li>}
            {found.map((part) => (
              <li key={`${part.what} ${part.id}`}>
                <button
                  type="button"
                  aria-pressed={part.id === chosen?.id && part.what === chosen.what}
                  onClick={() => onChoose(part)}
                >
                  <code>{part.id}</code>
                  <span className="quiet">{part.what}</span>
                </button>
              </li>
            ))}
          </ul>
        )}
      </div>
    </section>
  );
}
