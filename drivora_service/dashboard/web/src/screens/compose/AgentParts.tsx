import type { Schemas } from "../../api/client";
import { Field, fieldId } from "../../components/fields/Field";
import { valueAt } from "../../components/fields/pointers";
import { Prose } from "../../components/Prose";
import { parameterSchemas } from "./catalogues";
import type { Form } from "./form";
import { ParameterFields } from "./ParameterFields";
import { Folded } from "./Section";

type Agent = Schemas["Agent"];

/** Chooses an ADS; those that cannot be used here are shown and cannot be chosen. */
export function AgentSelect({
  id,
  label,
  agents,
  value,
  none,
  isInvalid = false,
  onChange,
}: {
  readonly id?: string;
  readonly label: string;
  readonly agents: readonly Agent[];
  readonly value: string;
  /** What no choice means. */
  readonly none: string;
  readonly isInvalid?: boolean;
  readonly onChange: (name: string) => void;
}) {
  const isKnown = value === "" || agents.some(({ name }) => name === value);
  const usable = agents.filter(({ installed }) => installed);
  const others = agents.filter(({ installed }) => !installed);
  return (
    <select
      id={id}
      aria-label={label}
      aria-invalid={isInvalid}
      value={value}
      onChange={({ target }) => onChange(target.value)}
    >
      <option value="">{none}</option>
      {!isKnown && <option value={value}>{value}, unknown here</option>}
      {usable.map(({ name }) => (
        <option key={name}>{name}</option>
      ))}
      {others.length > 0 && (
        <optgroup label="Not installed here">
          {others.map(({ name }) => (
            <option key={name} disabled>
              {name}
            </option>
          ))}
        </optgroup>
      )}
    </select>
  );
}

/** The parameters of an ADS. */
export function AgentSettings({
  form,
  pointer,
}: {
  readonly form: Form;
  readonly pointer: string;
}) {
  const name = valueAt(form.draft.settings, `${pointer}/name`);
  const agent = form.catalogues.agents.find((one) => one.name === name);
  if (!agent) return null;
  const parameters = `${pointer}/parameters`;
  return (
    <>
      {agent.parameters === null ? (
        <Folded title="Parameters">
          <Field
            pointer={parameters}
            schema={{ type: "object", description: "It declares none: any can be given." }}
            label="Parameters"
            value={valueAt(form.draft.settings, parameters)}
            problems={form.problemsOf(parameters, { inside: true })}
            onChange={(value) => form.set(parameters, value)}
          />
        </Folded>
      ) : (
        <ParameterFields
          form={form}
          pointer={parameters}
          properties={parameterSchemas(agent.parameters)}
        />
      )}
    </>
  );
}

/** The ADSs that cannot be used here, each with what to do. */
export function NotInstalled({ agents }: { readonly agents: readonly Agent[] }) {
  const missing = agents.filter(({ installed }) => !installed);
  if (missing.length === 0) return null;
  return (
    <Folded title={`${missing.length} more are not installed here`}>
      <dl className="facts-list">
        {missing.map(({ name, reason }) => (
          <div key={name} style={{ display: "contents" }}>
            <dt>{name}</dt>
            <dd>
              <Prose text={reason} />
            </dd>
          </div>
        ))}
      </dl>
    </Folded>
  );
}

/** Returns the id of the element that chooses the ADS at a place. */
export function agentFieldId(pointer: string): string {
  return fieldId(`${pointer}/name`);
}
