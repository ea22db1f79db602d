import { isObject, type JsonObject } from "../components/fields/pointers";

/** A document of a file. */
export interface FileDocument {
  /** Its name without the ending. */
  readonly name: string;
  readonly document: JsonObject;
}

/** Reads a document from the text of a file, JSON or YAML; errors name the file. */
export async function readDocument(fileName: string, text: string): Promise<FileDocument> {
  const name = fileName.replace(/\.(json|ya?ml)$/i, "");
  const isYaml = /\.ya?ml$/i.test(fileName);
  let document: unknown;
  try {
    // Its code is loaded when the first file needs it.
    document = isYaml ? (await import("./yaml")).readYaml(text) : JSON.parse(text);
  } catch (error) {
    const why = error instanceof Error ? error.message : String(error);
    throw new SyntaxError(`${fileName} is not ${isYaml ? "YAML" : "JSON"}: ${why}`);
  }
  if (!isObject(document))
    throw new SyntaxError(`${fileName} is not one object with keys, as a document is.`);
  return { name, document };
}

/** Returns a name as the name of a file. */
export function fileNameOf(name: string): string {
  const plain = name
    .normalize("NFKD")
    .replace(/[^\w.-]+/g, "-")
    .replace(/^[-.]+|[-.]+$/g, "");
  return plain.slice(0, 80) || "document";
}
