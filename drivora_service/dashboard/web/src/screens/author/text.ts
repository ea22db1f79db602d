import { Document, isMap, isNode, isScalar, isSeq, parseDocument, visit } from "yaml";
import { isObject, type Json, type JsonObject, keysOf } from "../../components/fields/pointers";

export type Language = "json" | "yaml";

/** What a text says, or where it cannot be read. */
export type Read =
  | { readonly document: JsonObject }
  | { readonly error: string; readonly from: number; readonly to: number };

/** Longest list or object that is written in one line, in characters. */
const LONGEST_LINE = 90;

/** Reads a document from a text. */
export function readText(text: string, language: Language): Read {
  const wrong = (error: string, from = 0, to = from): Read => ({ error, from, to });
  if (language === "json") {
    try {
      return asDocument(JSON.parse(text) as Json, wrong);
    } catch (error) {
      const told = error instanceof Error ? error.message : String(error);
      const place = Number(/position (\d+)/.exec(told)?.[1] ?? text.length);
      return wrong(`This is no JSON: ${told}`, place);
    }
  }
  const parsed = parseDocument(text, { merge: false });
  const [error] = parsed.errors;
  if (error) return wrong(`This is no YAML: ${error.message}`, ...error.pos);
  let alias: readonly [number, number] | undefined;
  visit(parsed, {
    Alias: (_, { range }) => {
      alias = range ? [range[0], range[1]] : [0, 0];
      return visit.BREAK;
    },
  });
  if (alias) return wrong("This is no YAML of a scenario: aliases are not allowed.", ...alias);
  return asDocument(parsed.toJS() as Json, wrong);
}

function asDocument(value: Json, wrong: (error: string) => Read): Read {
  if (isObject(value)) return { document: value };
  return wrong("A scenario is an object with keys, such as map_region and ego_vehicles.");
}

/** Writes a document; what is short stands in one line. */
export function writeText(document: JsonObject, language: Language): string {
  if (language === "json") return `${jsonText(document, "")}\n`;
  const written = new Document(document);
  visit(written, {
    Collection(_, node) {
      const plain = node.items.every((item) =>
        isScalar(isMap(node) ? (item as { value: unknown }).value : item),
      );
      const short = JSON.stringify(node.toJSON()).length <= LONGEST_LINE;
      if (plain && short && node !== written.contents) node.flow = true;
    },
  });
  return written.toString({ lineWidth: 0, flowCollectionPadding: false });
}

function jsonText(value: Json, indent: string): string {
  const isPlain = (one: Json) => one === null || typeof one !== "object";
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

/** Finds the parts of a text by their pointers; JSON is read as YAML, which contains it. */
export class TextPlaces {
  private readonly parsed: ReturnType<typeof parseDocument>;

  constructor(private readonly text: string) {
    this.parsed = parseDocument(text, { merge: false });
  }

  /** Returns where a part is, or the smallest part around it that is there. */
  rangeOf(pointer: string): { readonly from: number; readonly to: number } {
    let node: unknown = this.parsed.contents;
    let range = rangeOf(node);
    for (const key of keysOf(pointer)) {
      const next: unknown = isSeq(node)
        ? node.items[Number(key)]
        : isMap(node)
          ? (node.get(key, true) ?? undefined)
          : undefined;
      if (next === undefined) break;
      node = next;
      range = rangeOf(node) ?? range;
    }
    const [from = 0, to = from] = range ?? [];
    // An object of many lines is marked at its first.
    const end = this.text.indexOf("\n", from);
    return { from, to: Math.max(from, Math.min(to, end < 0 ? this.text.length : end)) };
  }
}

function rangeOf(node: unknown): readonly [number, number] | undefined {
  if (!isNode(node) || !node.range) return undefined;
  return [node.range[0], node.range[1]];
}
