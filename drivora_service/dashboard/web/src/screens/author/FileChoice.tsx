import { useRef } from "react";
import type { JsonObject } from "../../components/fields/pointers";
import { readDocument } from "../../documents/files";
import type { Origin } from "./origin";

const LARGEST_BYTES = 8_000_000;

/** A button that opens a scenario from a file, JSON or YAML. */
export function FileChoice({
  onOpen,
  onRefused,
}: {
  readonly onOpen: (document: JsonObject, origin: Origin) => void;
  readonly onRefused: (message: string) => void;
}) {
  const input = useRef<HTMLInputElement>(null);
  const read = async (file: File | undefined) => {
    if (!file) return;
    if (file.size > LARGEST_BYTES)
      return onRefused(`${file.name} is longer than ${LARGEST_BYTES / 1e6} MB.`);
    try {
      const { name, document } = await readDocument(file.name, await file.text());
      onRefused("");
      onOpen(document, { label: name, run: "" });
    } catch (error) {
      onRefused(error instanceof Error ? error.message : String(error));
    }
  };
  return (
    <>
      <button type="button" onClick={() => input.current?.click()}>
        Open a file
      </button>
      <input
        ref={input}
        type="file"
        hidden
        accept=".json,.yaml,.yml"
        aria-label="Scenario file"
        onChange={({ target }) => {
          void read(target.files?.[0]);
          target.value = "";
        }}
      />
    </>
  );
}
