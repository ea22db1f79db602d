import { useNavigate } from "@tanstack/react-router";
import { type Search, stringifySearch } from "../address";
import { Menu } from "../components/Menu";
import { sameSearch, useViews } from "./views";

/** Views of a list: those that the page gives, and those that the reader saved under a name. */
export function ViewMenu({
  list,
  given,
  search,
}: {
  readonly list: string;
  readonly given: readonly { readonly name: string; readonly search: Search }[];
  readonly search: Search;
}) {
  const navigate = useNavigate();
  const { views, save, remove } = useViews(list);
  const now = [...views, ...given].find((view) => sameSearch(view.search, search));
  const entry = (view: { name: string; search: Search }, close: () => void) => (
    <button
      type="button"
      className="item"
      aria-pressed={view === now}
      onClick={() => {
        void navigate({ to: ".", search: view.search });
        close();
      }}
    >
      <span className="word">{view.name}</span>
    </button>
  );
  return (
    <Menu
      align="right"
      label={now ? `View: ${now.name}` : "Views"}
      title="Filters and order under a name"
    >
      {(close) => (
        <>
          <ul className="menu-list">
            {given.map((view) => (
              <li key={view.name}>{entry(view, close)}</li>
            ))}
            {views.map((view) => (
              <li key={view.name} style={{ display: "flex" }}>
                {entry(view, close)}
                <button
                  type="button"
                  className="plain"
                  aria-label={`Forget the view ${view.name}`}
                  onClick={() => remove(view.name)}
                >
                  ×
                </button>
              </li>
            ))}
          </ul>
          {!now && stringifySearch(search) !== "" && (
            <form
              className="row"
              onSubmit={(event) => {
                event.preventDefault();
                const name = String(new FormData(event.currentTarget).get("name") ?? "").trim();
                if (!name) return;
                save(name, search);
                close();
              }}
            >
              <input
                name="name"
                aria-label="Name of this view"
                placeholder="Name of this view"
                maxLength={60}
              />
              <button type="submit">Save</button>
            </form>
          )}
        </>
      )}
    </Menu>
  );
}
