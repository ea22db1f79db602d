import { useState } from "react";
import type { Search } from "../address";
import { chosenValues, type Filter, offered, withToggled, wordsFor } from "./filterValues";
import { Menu } from "./Menu";
import { count, moment } from "./numbers";
import { TimeChoice } from "./TimeChoice";

const MANY = 10;

/** One filter: a button that says what is set, and the values with their counts below it. */
export function FilterMenu({
  filter,
  search,
  onChange,
}: {
  readonly filter: Filter;
  readonly search: Search;
  readonly onChange: (search: Search) => void;
}) {
  const chosen = chosenValues(search, filter);
  const { title, time } = filter;
  const said = chosen.map((value) => (time ? moment(value).slice(0, 16) : wordsFor(filter, value)));
  return (
    <Menu
      active={chosen.length > 0}
      {...(filter.hint ? { title: filter.hint } : {})}
      label={
        chosen.length > 0 ? (
          <>
            <span className="quiet">{title}</span> {said.slice(0, 2).join(", ")}
            {said.length > 2 && ` +${said.length - 2}`}
          </>
        ) : (
          title
        )
      }
    >
      {(close) =>
        time ? (
          <TimeChoice
            value={chosen[0] ?? ""}
            onChoose={(value) => {
              onChange({ ...search, [filter.name]: value ? [value] : [] });
              close();
            }}
          />
        ) : filter.values || filter.counts ? (
          <Values filter={filter} search={search} onChange={onChange} close={close} />
        ) : (
          <Typed
            filter={filter}
            chosen={chosen}
            onTyped={(value) => {
              onChange({ ...search, [filter.name]: value ? [value] : [] });
              close();
            }}
          />
        )
      }
    </Menu>
  );
}

function Values({
  filter,
  search,
  onChange,
  close,
}: {
  readonly filter: Filter;
  readonly search: Search;
  readonly onChange: (search: Search) => void;
  readonly close: () => void;
}) {
  const [typed, setTyped] = useState("");
  const chosen = chosenValues(search, filter);
  const all = offered(filter, chosen);
  const shown = all.filter((value) =>
    wordsFor(filter, value).toLowerCase().includes(typed.toLowerCase()),
  );
  return (
    <>
      {all.length > MANY && (
        <input
          className="wide"
          aria-label={`Find a value of ${filter.title}`}
          placeholder="Find"
          value={typed}
          onChange={(event) => setTyped(event.target.value)}
          onKeyDown={(event) => {
            if (event.key !== "Enter" || !shown[0]) return;
            // Closing gives the button the focus: the same key must not open the menu again.
            event.preventDefault();
            onChange(withToggled(search, filter, shown[0]));
            close();
          }}
        />
      )}
      <ul className="menu-list">
        {shown.map((value) => (
          <li key={value}>
            <button
              type="button"
              className="item"
              aria-pressed={chosen.includes(value)}
              data-none={filter.counts && !filter.counts[value]}
              onClick={() => {
                onChange(withToggled(search, filter, value));
                if (filter.single) close();
              }}
            >
              <span className="word">{wordsFor(filter, value)}</span>
              {filter.counts && <span className="quiet">{count(filter.counts[value] ?? 0)}</span>}
            </button>
          </li>
        ))}
      </ul>
      {shown.length === 0 && <p className="quiet note">No value to choose.</p>}
    </>
  );
}

function Typed({
  filter,
  chosen,
  onTyped,
}: {
  readonly filter: Filter;
  readonly chosen: readonly string[];
  readonly onTyped: (value: string) => void;
}) {
  return (
    <form
      className="row"
      onSubmit={(event) => {
        event.preventDefault();
        onTyped(String(new FormData(event.currentTarget).get("value") ?? "").trim());
      }}
    >
      <input name="value" aria-label={filter.title} defaultValue={chosen[0] ?? ""} size={26} />
      <button type="submit">Apply</button>
    </form>
  );
}
