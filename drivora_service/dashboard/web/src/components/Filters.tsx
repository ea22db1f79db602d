import { useNavigate } from "@tanstack/react-router";
import { useRef } from "react";
import { type Search, valuesOf } from "../address";
import { useKeys } from "../shell/keys";
import { FilterMenu } from "./FilterMenu";
import { type Filter, withoutFilters } from "./filterValues";

export type { Filter } from "./filterValues";

/** Filters of a list: they are in the address, so that a link shows the same. `/` goes to them. */
export function Filters({
  filters,
  search,
  children,
}: {
  readonly filters: readonly Filter[];
  readonly search: Search;
  readonly children?: React.ReactNode;
}) {
  const navigate = useNavigate();
  const frame = useRef<HTMLElement>(null);
  useKeys([
    {
      keys: "/",
      does: "filter",
      run: () => frame.current?.querySelector<HTMLElement>("button.opens")?.click(),
    },
  ]);
  const go = (to: Search) => void navigate({ to: ".", search: to, replace: true });
  const anySet = filters.some(({ name }) => valuesOf(search, name).length > 0);
  return (
    <search ref={frame} className="filters">
      {filters.map((filter) => (
        <FilterMenu key={filter.name} filter={filter} search={search} onChange={go} />
      ))}
      {anySet && (
        <button
          type="button"
          className="plain clear"
          onClick={() => go(withoutFilters(search, filters))}
        >
          Clear filters
        </button>
      )}
      {children}
    </search>
  );
}
