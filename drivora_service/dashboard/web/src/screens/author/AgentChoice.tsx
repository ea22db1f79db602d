import type { Schemas } from "../../api/client";
import { Fields, fieldId, Problems } from "../../components/fields/Field";
import type { JsonSchema } from "../../components/fields/jsonSchema";
import { isObject, type Json, valueAt } from "../../components/fields/pointers";
import { type Editing, problemsOf } from "./editing";

/** The ADS that drives an ego, with its parameters. */
export function AgentChoice({
  editing,
  pointer,
  agents,
}: {
  readonly editing: Editing;
  readonly pointer: string;
  readonly agents: readonly Schemas["Agent"][];
}) {
  const name = valueAt(editing.scenario, `${pointer}/agent/name`);
  const byFile = valueAt(editing.scenario, `${pointer}/config_path`);
  const parameters = valueAt(editing.scenario, `${pointer}/agent/parameters`);
  const place = `${pointer}/agent/name`;
  const problems = problemsOf(editing)(place);
  const chosen = agents.find((agent) => agent.name === name);
  const described = chosen?.parameters ?? [];
  const choose = (next: string) => {
    if (byFile !== undefined) editing.set(`${pointer}/config_path`, undefined);
    editing.set(`${pointer}/agent`, next === "" ? undefined : { name: next });
  };
  return (
    <>
      <div className="field" data-kind="choice">
        <label htmlFor={fieldId(place)}>ADS</label>
        <span className="control">
          <select
            id={fieldId(place)}
            value={typeof name === "string" ? name : ""}
            aria-invalid={problems.length > 0}
            onChange={({ target }) => choose(target.value)}
          >
            <option value="">
              {typeof byFile === "string" ? `by its file: ${byFile}` : "idm, unless a run says so"}
            </option>
            {typeof name === "string" && !chosen && <option value={name}>{name}</option>}
            {agents.map((agent) => (
              <option key={agent.name} value={agent.name}>
                {agent.name}
                {agent.installed ? "" : " (not installed)"}
              </option>
            ))}
          </select>
        </span>
        <div className="about">
          {chosen && <p className="quiet">{chosen.description}</p>}
          <Problems problems={problems} />
        </div>
      </div>
      {described.length > 0 && (
        <details className="author-more" open={isObject(parameters)}>
          <summary>Parameters of {chosen?.name}</summary>
          <Fields
            pointer={`${pointer}/agent/parameters`}
            properties={Object.fromEntries(
              described.map((one) => [one.name, schemaOf(one)] as const),
            )}
            value={isObject(parameters) ? parameters : {}}
            problemsOf={problemsOf(editing)}
            onChange={editing.set}
          />
        </details>
      )}
    </>
  );
}

function schemaOf(parameter: Schemas["AgentParameter"]): JsonSchema {
  const { values, description } = parameter;
  return { ...(values as JsonSchema), description, default: parameter.default as Json };
}
