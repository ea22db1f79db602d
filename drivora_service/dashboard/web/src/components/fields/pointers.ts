/** Any value of JSON. */
export type Json =
  | null
  | boolean
  | number
  | string
  | readonly Json[]
  | { readonly [key: string]: Json };
export type JsonObject = { readonly [key: string]: Json };

export function isObject(value: unknown): value is JsonObject {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

/** Returns the keys of a JSON pointer (RFC 6901). */
export function keysOf(pointer: string): readonly string[] {
  if (pointer === "") return [];
  return pointer
    .slice(1)
    .split("/")
    .map((key) => key.replaceAll("~1", "/").replaceAll("~0", "~"));
}

/** Returns the pointer to a part of what another points to. */
export function below(pointer: string, key: string | number): string {
  return `${pointer}/${String(key).replaceAll("~", "~0").replaceAll("/", "~1")}`;
}

/** Returns a pointer and those to all that surrounds its place, the nearest first. */
export function ancestry(pointer: string): readonly string[] {
  const found = [pointer];
  for (let rest = pointer; rest !== ""; found.push(rest))
    rest = rest.slice(0, rest.lastIndexOf("/"));
  return found;
}

/** Returns what is at a place of a document; `undefined` if nothing is. */
export function valueAt(document: Json | undefined, pointer: string): Json | undefined {
  let found = document;
  for (const key of keysOf(pointer)) {
    if (Array.isArray(found)) found = found[Number(key)];
    else if (isObject(found)) found = found[key];
    else return undefined;
  }
  return found;
}

/**
 * Returns a document with another value at a place; without a value the place is removed.
 *
 * Objects on the way are made, and those that become empty are removed.
 */
export function withValue(
  document: JsonObject,
  pointer: string,
  value: Json | undefined,
): JsonObject {
  const changed = replaced(document, keysOf(pointer), value);
  return isObject(changed) ? changed : {};
}

function replaced(
  now: Json | undefined,
  [key, ...rest]: readonly string[],
  value: Json | undefined,
): Json | undefined {
  if (key === undefined) return value;
  if (Array.isArray(now)) {
    const items: readonly Json[] = now;
    const place = Number(key);
    const item = replaced(items[place], rest, value);
    if (item === undefined && rest.length === 0) return items.toSpliced(place, 1);
    return items.toSpliced(place, 1, item ?? {});
  }
  const { [key]: inside, ...others } = isObject(now) ? now : {};
  const item = replaced(inside, rest, value);
  // A key stays where it was.
  const entries = Object.entries(isObject(now) ? now : {});
  const kept =
    item === undefined
      ? others
      : inside === undefined
        ? { ...others, [key]: item }
        : Object.fromEntries(entries.map(([name, was]) => [name, name === key ? item : was]));
  return Object.keys(kept).length === 0 ? undefined : kept;
}

/** What is wrong at a place of a document. */
export interface PlacedProblem {
  readonly pointer: string;
  readonly message: string;
}

/** Returns the problems of a place; `inside` also those of what is in it. */
export function problemsAt<Problem extends PlacedProblem>(
  problems: readonly Problem[],
  pointer: string,
  { inside = false }: { readonly inside?: boolean } = {},
): readonly Problem[] {
  return problems.filter(
    (one) => one.pointer === pointer || (inside && one.pointer.startsWith(`${pointer}/`)),
  );
}
