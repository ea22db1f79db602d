import { parseSearch, type Search, stringifySearch } from "../address";
import { useRemembered } from "./remembered";

/** A part of an address with a name that the reader gave it. */
export interface View {
  readonly name: string;
  /** As in an address: `?status=finished`. */
  readonly search: string;
}

export function readViews(stored: unknown): readonly View[] {
  if (!Array.isArray(stored)) return [];
  return stored.filter(
    (item): item is View => typeof item?.name === "string" && typeof item?.search === "string",
  );
}

/** Returns whether two addresses show the same, in whatever order their parts are. */
export function sameSearch(one: Search, other: Search): boolean {
  const parts = (search: Search) =>
    new URLSearchParams(stringifySearch(search)).toString().split("&").sort().join("&");
  return parts(one) === parts(other);
}

/** The views of a list that this browser keeps. */
export function useViews(list: string) {
  const [views, set] = useRemembered(`drivora-views-${list}`, readViews);
  const others = (name: string) => views.filter((view) => view.name !== name);
  return {
    views: views.map(({ name, search }) => ({ name, search: parseSearch(search) as Search })),
    save: (name: string, search: Search) =>
      set([...others(name), { name, search: stringifySearch(search) }]),
    remove: (name: string) => set(others(name)),
  };
}
