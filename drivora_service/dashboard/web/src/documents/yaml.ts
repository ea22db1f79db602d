import {
  Document,
  isCollection,
  isMap,
  isPair,
  isScalar,
  parseDocument,
  type Tags,
  visit,
} from "yaml";
import type { Json } from "../components/fields/pointers";
import { LONGEST_LINE } from "./json";

/** Values of YAML 1.1 that JSON does not have: they stay text, and the service says what is wrong. */
const NOT_JSON = new Set(["timestamp", "binary", "omap", "pairs", "set", "merge"]);

const TRUE = /^(?:yes|true|on)$/i;
const FALSE = /^(?:no|false|off)$/i;

/** Makes the library read and write the words that the service does: `y` is a coordinate. */
const asService = (tags: Tags): Tags =>
  tags.flatMap((tag): Tags => {
    if (typeof tag === "string") return NOT_JSON.has(tag) ? [] : [tag];
    const name = lastWord(tag.tag);
    if (NOT_JSON.has(name)) return [];
    if (name !== "bool" || !("test" in tag) || !tag.test) return [tag];
    return [{ ...tag, test: tag.test.test("true") ? TRUE : FALSE }];
  });

function lastWord(tag: string): string {
  return tag.slice(tag.lastIndexOf(":") + 1);
}

/** A mistake of a text, and where it is. */
export class YamlError extends SyntaxError {
  constructor(
    message: string,
    readonly from: number,
    readonly to: number,
  ) {
    super(message);
  }
}

/** Returns the parts of a text as the service reads them; mistakes are in them. */
export function parsedYaml(text: string) {
  return parseDocument(text, { version: "1.1", customTags: asService, prettyErrors: true });
}

/** Reads YAML as the service does: version 1.1, without anchors and aliases. */
export function readYaml(text: string): Json {
  const read = parsedYaml(text);
  const [error] = read.errors;
  if (error) throw new YamlError(error.message.split("\n")[0] ?? "", ...error.pos);
  visit(read, {
    Alias: (_, { range }) => {
      const [from = 0, to = from] = range ?? [];
      throw new YamlError("found an alias; write out what it stands for", from, to);
    },
  });
  return read.toJS() as Json;
}

/** Writes YAML that the service reads back to the same: lists and objects of a line on one line. */
export function writeYaml(value: Json): string {
  const written = new Document(value, {
    version: "1.1",
    customTags: (tags) => [EXPONENT, ...asService(tags)],
    aliasDuplicateObjects: false,
  });
  visit(written, {
    Collection: (_, node) => {
      const plain = node.items.every((item) => isScalar(isPair(item) ? item.value : item));
      node.flow = plain && JSON.stringify(node.toJSON()).length <= LONGEST_LINE;
      if (isCollection(node) && node.items.length === 0) node.flow = true;
    },
  });
  // The outermost object is always written line by line.
  if (isMap(written.contents)) written.contents.flow = false;
  return written.toString({ lineWidth: 0, flowCollectionPadding: false });
}

/** Numbers with an exponent: those who read YAML 1.1 need a point before it. */
const EXPONENT = {
  identify: (value: unknown) => typeof value === "number" && /e/.test(String(value)),
  default: true,
  tag: "tag:yaml.org,2002:float",
  test: /^$/,
  resolve: Number,
  stringify: ({ value }: { readonly value?: unknown }) =>
    String(value).replace(/^(-?\d+)e/, "$1.0e"),
} as const;
