import { useMemo, useRef, useState } from "react";
import type { Schemas } from "../../api/client";
import { useKeys } from "../../shell/keys";
import { type Part, partsNamed } from "../networks/search";
import { onWayFirst } from "./nearness";
import { type KindPlace, PLACE_KINDS, type PlaceKind, placesOf } from "./places";

const MOST = 40;

/** Finds parts of the network by name, and places by their kind. */
export function PlaceSearch({
  geometry,
  ways,
  onPart,
  onPlace,
  onDrive,
  onWalk,
}: {
  readonly geometry: Schemas["NetworkGeometry"];
  /** The ways of the egos. */
  readonly ways: readonly (readonly number[])[];
  readonly onPart: (part: Part) => void;
  readonly onPlace: (place: KindPlace) => void;
  /** An ego is to drive through it. */
  readonly onDrive: (place: KindPlace) => void;
  /** A walker is to cross there. */
  readonly onWalk: (place: KindPlace) => void;
}) {
  const [text, setText] = useState("");
  const [kind, setKind] = useState<PlaceKind | "">("");
  const [chosen, setChosen] = useState("");
  const field = useRef<HTMLInputElement>(null);
  useKeys([{ keys: "/", does: "search the map", run: () => field.current?.focus() }]);
  const all = useMemo(() => (kind ? placesOf(geometry, kind) : []), [geometry, kind]);
  const wanted = text.trim().toLowerCase();
  const places = onWayFirst(
    all.filter(
      ({ name, id }) => name.toLowerCase().includes(wanted) || id.toLowerCase().includes(wanted),
    ),
    ways,
  );
  const parts = kind ? [] : partsNamed(geometry, text);
  return (
    <section className="panel author-part" aria-label="Search">
      <div className="inside author-search">
        <select
          aria-label="Kind of place"
          value={kind}
          onChange={({ target }) => setKind(target.value as PlaceKind | "")}
        >
          <option value="">any part by its name</option>
          {PLACE_KINDS.map((one) => (
            <option key={one}>{one}</option>
          ))}
        </select>
        <input
          ref={field}
          type="search"
          placeholder={kind ? "Street or junction" : "Lane, junction, street"}
          aria-label="Search the map"
          value={text}
          onChange={({ target }) => setText(target.value)}
          onKeyDown={(event) => {
            if (event.key === "Escape") event.currentTarget.blur();
            if (event.key !== "Enter") return;
            if (places[0]) onPlace(places[0].place);
            else if (parts[0]) onPart(parts[0]);
          }}
        />
        {kind && (
          <ul className="found">
            {places.length === 0 && <li className="quiet">This network has none.</li>}
            {places.slice(0, MOST).map(({ place, isOnWay }) => (
              <li key={place.id} className="author-place" data-chosen={place.id === chosen}>
                <button
                  type="button"
                  aria-pressed={place.id === chosen}
                  onClick={() => {
                    setChosen(place.id);
                    onPlace(place);
                  }}
                >
                  <span>
                    {place.name}
                    {isOnWay && <span className="quiet"> · on the ego's way</span>}
                  </span>
                </button>
                {place.id === chosen && place.drive && (
                  <button type="button" onClick={() => onDrive(place)}>
                    Ego drives it
                  </button>
                )}
                {place.id === chosen && place.walk && (
                  <button type="button" onClick={() => onWalk(place)}>
                    Walker crosses
                  </button>
                )}
              </li>
            ))}
            {places.length > MOST && (
              <li className="quiet">{places.length - MOST} more: name a street.</li>
            )}
          </ul>
        )}
        {!kind && text && (
          <ul className="found">
            {parts.length === 0 && <li className="quiet">Nothing has this name.</li>}
            {parts.map((part) => (
              <li key={`${part.what} ${part.id}`}>
                <button type="button" onClick={() => onPart(part)}>
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
