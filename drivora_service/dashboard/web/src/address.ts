/** The part of an address after `?` as plain words: `status=passed&status=failed`. */
export type Search = Readonly<Record<string, string | readonly string[] | undefined>>;

export function parseSearch(text: string): Record<string, string | string[]> {
  const found: Record<string, string | string[]> = {};
  for (const [name, value] of new URLSearchParams(text)) {
    const before = found[name];
    if (before === undefined) found[name] = value;
    else found[name] = Array.isArray(before) ? [...before, value] : [before, value];
  }
  return found;
}

export function stringifySearch(search: Search): string {
  const words = new URLSearchParams();
  for (const [name, value] of Object.entries(search)) {
    if (value === undefined || value === "") continue;
    for (const item of typeof value === "string" ? [value] : value) words.append(name, item);
  }
  const text = words.toString();
  return text === "" ? "" : `?${text}`;
}

/** Returns all values of a name. */
export function valuesOf(search: Search, name: string): readonly string[] {
  const value = search[name];
  if (value === undefined) return [];
  return typeof value === "string" ? [value] : value;
}

/** Returns the first value of a name, "" if there is none. */
export function firstOf(search: Search, name: string): string {
  return valuesOf(search, name)[0] ?? "";
}
