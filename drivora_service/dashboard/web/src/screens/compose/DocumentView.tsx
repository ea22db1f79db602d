import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { Copy } from "../../components/Copy";
import type { JsonObject } from "../../components/fields/pointers";
import { fileNameOf } from "../../documents/files";
import { writeJson } from "../../documents/json";
import { save } from "../../documents/save";
import { serviceAddress } from "../../service";
import type { Kind } from "./draft";

type Form = "json" | "yaml";

/** The service reads YAML up to this size only. */
const MOST_YAML_BYTES = 256 * 1024;

/** The document as text, to copy, to save, and to run by a command. */
export function DocumentView({
  kind,
  name,
  document,
}: {
  readonly kind: Kind;
  readonly name: string;
  readonly document: JsonObject;
}) {
  const [form, setForm] = useState<Form>("yaml");
  const yaml = useQuery({
    queryKey: ["yaml", document],
    // Its code is loaded when it is needed.
    queryFn: async () => (await import("../../documents/yaml")).writeYaml(document),
    enabled: form === "yaml",
    placeholderData: (before) => before,
    gcTime: 0,
  });
  const text = form === "json" ? writeJson(document) : (yaml.data ?? "");
  const file = `${fileNameOf(name)}.${form}`;
  const command = `drivora ${kind} run ${file} --server ${serviceAddress()}`;
  return (
    <section className="panel" aria-label="Document">
      <header>
        <h2>Document</h2>
        <fieldset className="doing">
          <legend className="hidden-visually">Language</legend>
          {(["yaml", "json"] as const).map((one) => (
            <button
              key={one}
              type="button"
              aria-pressed={form === one}
              onClick={() => setForm(one)}
            >
              {one.toUpperCase()}
            </button>
          ))}
        </fieldset>
        <span className="actions doing">
          <Copy text={text} label="Copy" />
          <button type="button" onClick={() => save(file, text)}>
            Download
          </button>
        </span>
      </header>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a part that scrolls is reached by keyboard */}
      <pre className="inside document" tabIndex={0}>
        {text}
      </pre>
      <footer className="inside">
        <p className="quiet">The file can be run by a command, too:</p>
        <p className="copies">
          <Copy text={command} />
        </p>
        {form === "yaml" && text.length > MOST_YAML_BYTES && (
          <p className="problem">YAML is read up to 256 KB only; use JSON.</p>
        )}
      </footer>
    </section>
  );
}
