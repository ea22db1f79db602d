import { Link } from "@tanstack/react-router";
import type { Search } from "../address";

export interface Tab {
  readonly name: string;
  readonly title: string;
  readonly count?: number | undefined;
}

/** Parts of a screen, one at a time; the address names the open one. */
export function Tabs({
  tabs,
  open,
  search,
}: {
  readonly tabs: readonly Tab[];
  readonly open: string;
  readonly search: Search;
}) {
  return (
    <nav className="tabs" aria-label="Parts of this screen">
      {tabs.map(({ name, title, count }) => (
        <Link
          key={name}
          to="."
          search={{ ...search, tab: name }}
          replace
          resetScroll={false}
          aria-current={name === open ? "page" : undefined}
        >
          {title}
          {count !== undefined && <span className="quiet"> {count}</span>}
        </Link>
      ))}
    </nav>
  );
}
