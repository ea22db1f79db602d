import type { Json, JsonObject } from "../components/fields/pointers";

/** Longest list or object that is written in one line, in characters. */
export const LONGEST_LINE = 90;

/** Writes JSON; what is short and has no parts stands in one line. */
export function writeJson(document: JsonObject): string {
  return `${jsonText(document, "")}\n`;
}

function jsonText(value: Json, indent: string): string {
  if (isPlain(value)) return JSON.stringify(value);
  const inner = `${indent}  `;
  if (Array.isArray(value)) {
    const items: readonly Json[] = value;
    if (items.length === 0) return "[]";
    if (items.every(isPlain)) {
      const line = `[${items.map((item) => JSON.stringify(item)).join(", ")}]`;
      if (line.length <= LONGEST_LINE) return line;
    }
    return `[\n${items.map((item) => inner + jsonText(item, inner)).join(",\n")}\n${indent}]`;
  }
  const entries = Object.entries(value as JsonObject);
  if (entries.length === 0) return "{}";
  const pair = ([key, item]: [string, Json]) => `${JSON.stringify(key)}: ${jsonText(item, inner)}`;
  if (indent !== "" && entries.every(([, item]) => isPlain(item))) {
    const line = `{ ${entries.map(pair).join(", ")} }`;
    if (line.length <= LONGEST_LINE) return line;
  }
  return `{\n${entries.map((entry) => inner + pair(entry)).join(",\n")}\n${indent}}`;
}

function isPlain(value: Json): boolean {
  return value === null || typeof value !== "object";
}
