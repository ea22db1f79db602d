import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { api, body } from "../../api/client";
import type { JsonObject } from "../../components/fields/pointers";
import { ofRun } from "./beginning";
import "./compose.css";
import type { FoundScenario } from "./draft";

/** Where scenarios come from: files, runs of the service and examples. */
export function ScenarioSources({
  isFirst,
  onFiles,
  onAdd,
  onRefused,
}: {
  readonly isFirst: boolean;
  readonly onFiles: (files: readonly File[]) => void;
  readonly onAdd: (scenario: FoundScenario) => void;
  readonly onRefused: (text: string) => void;
}) {
  return (
    <div className="sources">
      <span className="quiet">
        {isFirst ? "Drop a file here (JSON or YAML), or" : "Another one:"}
      </span>
      <label className="button pick">
        Choose a file
        <input
          type="file"
          className="hidden-visually"
          accept=".json,.yaml,.yml"
          multiple
          onChange={({ target }) => {
            onFiles([...(target.files ?? [])]);
            // The same file can be chosen again after a change.
            target.value = "";
          }}
        />
      </label>
      <RunSource onAdd={onAdd} onRefused={onRefused} />
      <ExampleSource onAdd={onAdd} />
    </div>
  );
}

/** Takes the scenario of a run by its id. */
export function RunSource({
  onAdd,
  onRefused,
}: {
  readonly onAdd: (scenario: FoundScenario) => void;
  readonly onRefused: (text: string) => void;
}) {
  const [id, setId] = useState("");
  const [isAsked, setAsked] = useState(false);
  const newest = useQuery({
    queryKey: ["run", "list", "compose"],
    queryFn: async () =>
      body(await api.GET("/api/v1/runs", { params: { query: { limit: 50 } } })).items,
    enabled: isAsked,
  });
  const take = async () => {
    if (id.trim() === "") return;
    try {
      onAdd(await ofRun(id.trim()));
      setId("");
    } catch (error) {
      onRefused(error instanceof Error ? error.message : String(error));
    }
  };
  return (
    <span className="doing">
      <input
        aria-label="Id of a run"
        placeholder="id of a run"
        list="newest-runs"
        autoComplete="off"
        value={id}
        onFocus={() => setAsked(true)}
        onChange={({ target }) => setId(target.value)}
        onKeyDown={(event) => {
          if (event.key !== "Enter" || event.ctrlKey || event.metaKey) return;
          event.preventDefault();
          void take();
        }}
      />
      <datalist id="newest-runs">
        {newest.data?.map((run) => (
          <option key={run.id} value={run.id}>
            {[run.label, run.configuration, run.town].filter(Boolean).join(", ")}
          </option>
        ))}
      </datalist>
      <button type="button" disabled={id.trim() === ""} onClick={() => void take()}>
        Take its scenario
      </button>
    </span>
  );
}

/** Chooses one of the example scenarios of the package. */
export function ExampleSource({ onAdd }: { readonly onAdd: (scenario: FoundScenario) => void }) {
  const [name, setName] = useState("");
  const { data } = useQuery({
    queryKey: ["example-scenarios"],
    queryFn: async () => body(await api.GET("/api/v1/scenarios:examples")).items,
  });
  const chosen = data?.find((one) => one.name === name);
  return (
    <span className="doing">
      <select
        aria-label="Example scenario"
        value={name}
        onChange={({ target }) => setName(target.value)}
      >
        <option value="">an example</option>
        {data?.map((one) => (
          <option key={one.name}>{one.name}</option>
        ))}
      </select>
      <button
        type="button"
        disabled={!chosen}
        onClick={() => {
          if (!chosen) return;
          const document = chosen.document as JsonObject;
          onAdd({ label: chosen.name, origin: "an example", document });
          setName("");
        }}
      >
        Use it
      </button>
    </span>
  );
}
