import { useNavigate } from "@tanstack/react-router";
import { type KeyboardEvent, useRef, useState } from "react";
import { type Found, type FoundKind, matching } from "./found";
import { useKeys } from "./keys";
import { NEWEST, useFound } from "./useFound";

const WORDS: Readonly<Record<FoundKind, string>> = {
  run: "run",
  batch: "batch",
  campaign: "campaign",
  study: "study",
  minimization: "minimisation",
  network: "network",
  agent: "ADS",
};

/** Finds what has an id or a name, and opens it. */
export function SearchField() {
  const navigate = useNavigate();
  const field = useRef<HTMLInputElement>(null);
  const [open, setOpen] = useState(false);
  const [text, setText] = useState("");
  const [place, setPlace] = useState(0);
  const all = useFound(open, text);
  const shown = matching(all, text);
  useKeys([
    { keys: "s", does: "search everything", run: () => field.current?.focus() },
    { keys: "/", does: "search everything", run: () => field.current?.focus() },
  ]);
  const go = (found: Found | undefined) => {
    if (!found) return;
    setText("");
    setOpen(false);
    field.current?.blur();
    const { kind, id } = found;
    if (kind === "run") void navigate({ to: "/runs/$runId", params: { runId: id } });
    else if (kind === "campaign") void navigate({ to: "/campaigns/$id", params: { id } });
    else if (kind === "study") void navigate({ to: "/studies/$id", params: { id } });
    else if (kind === "minimization") void navigate({ to: "/minimizations/$id", params: { id } });
    else if (kind === "batch") void navigate({ to: "/batches/$batchId", params: { batchId: id } });
    else if (kind === "network") void navigate({ to: "/networks/$name", params: { name: id } });
    else if (kind === "agent") void navigate({ to: "/agents", search: {}, hash: id });
  };
  const onKeyDown = (event: KeyboardEvent) => {
    if (event.key === "ArrowDown") setPlace(Math.min(place + 1, shown.length - 1));
    else if (event.key === "ArrowUp") setPlace(Math.max(place - 1, 0));
    else if (event.key === "Enter") go(shown[place]);
    else if (event.key === "Escape") field.current?.blur();
    else return;
    event.preventDefault();
  };
  return (
    <search className="find">
      <input
        ref={field}
        type="search"
        role="combobox"
        aria-label="Search by id or name"
        aria-expanded={open && text !== ""}
        aria-controls="found"
        aria-activedescendant={shown[place] ? `found-${place}` : undefined}
        autoComplete="off"
        placeholder="Search id or name"
        value={text}
        onFocus={() => setOpen(true)}
        onBlur={() => setOpen(false)}
        onChange={(event) => {
          setText(event.target.value);
          setPlace(0);
        }}
        onKeyDown={onKeyDown}
      />
      {open && text.trim() !== "" && (
        // The press must not take the focus away before the click arrives.
        <div
          id="found"
          role="listbox"
          aria-label="Found"
          tabIndex={-1}
          className="menu-panel"
          data-align="right"
          onPointerDown={(event) => event.preventDefault()}
        >
          {shown.map((found, at) => (
            <button
              key={`${found.kind} ${found.id}`}
              id={`found-${at}`}
              type="button"
              role="option"
              tabIndex={-1}
              aria-selected={at === place}
              className="item"
              onClick={() => go(found)}
            >
              <span className="quiet kind">{WORDS[found.kind]}</span>
              <span className="word">{found.name}</span>
              <span className="quiet">{found.note}</span>
            </button>
          ))}
          {shown.length === 0 && (
            <p className="quiet note">
              Nothing has this id, and none of the newest {NEWEST} of a kind has this name. The
              filters of Runs find older ones.
            </p>
          )}
        </div>
      )}
    </search>
  );
}
