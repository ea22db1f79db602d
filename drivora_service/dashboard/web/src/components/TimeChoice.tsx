import { useState } from "react";

const HOUR_MS = 3_600_000;
const BACK = [
  { words: "1 hour ago", ms: HOUR_MS },
  { words: "24 hours ago", ms: 24 * HOUR_MS },
  { words: "7 days ago", ms: 7 * 24 * HOUR_MS },
  { words: "30 days ago", ms: 30 * 24 * HOUR_MS },
] as const;

/** Returns a time as an input of the browser takes it: `2026-11-24T02:15`, in the reader's zone. */
export function localInput(iso: string): string {
  if (!iso) return "";
  const at = new Date(iso);
  return new Date(at.getTime() - at.getTimezoneOffset() * 60_000).toISOString().slice(0, 16);
}

/** A time: some way back, or typed; the address keeps it with its zone. */
export function TimeChoice({
  value,
  onChoose,
}: {
  readonly value: string;
  readonly onChoose: (iso: string) => void;
}) {
  const [typed, setTyped] = useState(localInput(value));
  return (
    <>
      <ul className="menu-list">
        {BACK.map(({ words, ms }) => (
          <li key={words}>
            <button
              type="button"
              className="item"
              onClick={() => onChoose(new Date(Date.now() - ms).toISOString())}
            >
              {words}
            </button>
          </li>
        ))}
        {value && (
          <li>
            <button type="button" className="item" onClick={() => onChoose("")}>
              any time
            </button>
          </li>
        )}
      </ul>
      <form
        className="row"
        onSubmit={(event) => {
          event.preventDefault();
          onChoose(typed ? new Date(typed).toISOString() : "");
        }}
      >
        <input
          type="datetime-local"
          aria-label="Time"
          value={typed}
          onChange={(event) => setTyped(event.target.value)}
        />
        <button type="submit">Apply</button>
      </form>
    </>
  );
}
