import { useNavigate } from "@tanstack/react-router";
import { useRef } from "react";
import { type Search, valuesOf } from "../address";
import { useKeys } from "../shell/keys";

export interface Filter {
  /** Name of the parameter, in the address and in the API. */
  readonly name: string;
  readonly title: string;
  /** Allowed values; without them the reader types one. */
  readonly values?: readonly string[];
}

/** Filters of a list: they are in the address, so that a link shows the same. `/` goes to them. */
export function Filters({
  filters,
  search,
}: {
  readonly filters: readonly Filter[];
  readonly search: Search;
}) {
  const navigate = useNavigate();
  const first = useRef<HTMLSelectElement & HTMLInputElement>(null);
  useKeys([{ keys: "/", does: "filter", run: () => first.current?.focus() }]);
  const set = (name: string, values: readonly string[]) =>
    void navigate({ to: ".", search: { ...search, [name]: values }, replace: true });
  return (
    <search className="filters">
      {filters.map(({ name, title, values }, place) => (
        <label key={name} htmlFor={`filter-${name}`}>
          {title}
          {values ? (
            <select
              id={`filter-${name}`}
              ref={place === 0 ? first : undefined}
              value=""
              onChange={(event) => {
                const chosen = event.target.value;
                if (chosen) set(name, [...new Set([...valuesOf(search, name), chosen])]);
              }}
            >
              <option value="">any</option>
              {values.map((value) => (
                <option key={value} value={value}>
                  {value.replaceAll("_", " ")}
                </option>
              ))}
            </select>
          ) : (
            <input
              id={`filter-${name}`}
              ref={place === 0 ? first : undefined}
              size={14}
              onKeyDown={(event) => {
                const typed = event.currentTarget.value.trim();
                if (event.key !== "Enter" || !typed) return;
                event.currentTarget.value = "";
                set(name, [...new Set([...valuesOf(search, name), typed])]);
              }}
            />
          )}
        </label>
      ))}
      {filters.flatMap(({ name, title }) =>
        valuesOf(search, name).map((value) => (
          <span key={`${name} ${value}`} className="chip">
            {title}: {value.replaceAll("_", " ")}
            <button
              type="button"
              className="plain"
              aria-label={`Remove ${title} ${value}`}
              onClick={() =>
                set(
                  name,
                  valuesOf(search, name).filter((item) => item !== value),
                )
              }
            >
              ×
            </button>
          </span>
        )),
      )}
    </search>
  );
}
