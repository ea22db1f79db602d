/** A setting of several things: its path, and its value in each, in their order. */
export interface Setting {
  readonly path: string;
  readonly values: readonly string[];
}

/** Returns the leaves of a document by their paths; lists of objects are told by their length. */
export function flatten(value: unknown, path = ""): ReadonlyMap<string, string> {
  const found = new Map<string, string>();
  if (value === null || value === undefined) return found;
  if (Array.isArray(value)) {
    const simple = value.every((item) => typeof item !== "object");
    found.set(path, simple ? value.join(", ") : `${value.length}`);
    return found;
  }
  if (typeof value === "object") {
    for (const [name, item] of Object.entries(value)) {
      for (const [key, text] of flatten(item, path ? `${path}.${name}` : name))
        found.set(key, text);
    }
    return found;
  }
  found.set(path, String(value));
  return found;
}

/** Returns the settings in which some of the documents differ. */
export function differing(documents: readonly unknown[]): readonly Setting[] {
  const flat = documents.map((document) => flatten(document));
  const paths = new Set(flat.flatMap((one) => [...one.keys()]));
  return [...paths].flatMap((path) => {
    const values = flat.map((one) => one.get(path) ?? "");
    return new Set(values).size > 1 ? [{ path, values }] : [];
  });
}
