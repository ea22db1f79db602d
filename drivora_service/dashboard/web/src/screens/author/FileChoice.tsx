import { useRef } from "react";
import type { JsonObject } from "../../components/fields/pointers";
import { readText } from "./text";

const LARGEST_BYTES = 8_000_000;

/** A button that opens a scenario from a file, JSON or YAML. */
export function FileChoice({
  onOpen,
  onRefused,
}: {
  readonly onOpen: (document: JsonObject) => void;
  readonly onRefused: (message: string) => void;
}) {
  const input = useRef<HTMLInputElement>(null);
  const read = async (file: File | undefined) => {
    if (!file) return;
    if (file.size > LARGEST_BYTES)
      return onRefused(`${file.name} is longer than ${LARGEST_BYTES / 1e6} MB.`);
    const found = readText(await file.text(), /\.json$/i.test(file.name) ? "json" : "yaml");
    if ("error" in found) onRefused(`${file.name}: ${found.error}`);
    else {
      onRefused("");
      onOpen(found.document);
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
