import { isMap, isNode, isSeq } from "yaml";
import { isObject, type Json, type JsonObject, keysOf } from "../../components/fields/pointers";
import { writeJson } from "../../documents/json";
import { parsedYaml, readYaml, writeYaml, YamlError } from "../../documents/yaml";

export type Language = "json" | "yaml";

/** What a text says, or where it cannot be read. */
export type Read =
  | { readonly document: JsonObject }
  | { readonly error: string; readonly from: number; readonly to: number };

/** Reads a document from a text. */
export function readText(text: string, language: Language): Read {
  let value: Json;
  try {
    value = language === "json" ? (JSON.parse(text) as Json) : readYaml(text);
  } catch (error) {
    const told = error instanceof Error ? error.message : String(error);
    const [from, to] = placeOf(error, told, text.length);
    return { error: `This is no ${language.toUpperCase()}: ${told}`, from, to };
  }
  if (isObject(value)) return { document: value };
  const error = "A scenario is an object with keys, such as map_region and ego_vehicles.";
  return { error, from: 0, to: 0 };
}

/** Returns where a mistake is; browsers tell that of JSON in their message. */
function placeOf(error: unknown, told: string, end: number): readonly [number, number] {
  if (error instanceof YamlError) return [error.from, error.to];
  const place = Number(/position (\d+)/.exec(told)?.[1] ?? end);
  return [place, place];
}

/** Writes a document; what is short stands in one line. */
export function writeText(document: JsonObject, language: Language): string {
  return language === "json" ? writeJson(document) : writeYaml(document);
}

/** Finds the parts of a text by their pointers; JSON is read as YAML, which contains it. */
export class TextPlaces {
  private readonly parsed: ReturnType<typeof parsedYaml>;

  constructor(private readonly text: string) {
    this.parsed = parsedYaml(text);
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
