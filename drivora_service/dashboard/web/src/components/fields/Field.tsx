import type { ReactNode } from "react";
import { Prose } from "../Prose";
import { type ControlProps, controlFor } from "./controls";
import { type Definitions, type JsonSchema, labelOf, lookOf, resolved } from "./jsonSchema";
import { below, type Json, type PlacedProblem } from "./pointers";
import { isSame, textOf } from "./typed";
import "./fields.css";

export interface FieldProps {
  /** The place of the value in its document, by which problems and links find the field. */
  readonly pointer: string;
  readonly schema: JsonSchema;
  readonly definitions?: Definitions;
  readonly label: string;
  /** The value of the document; `undefined` where it has none. */
  readonly value: Json | undefined;
  /** What stands where the document has no value; else the default of the schema. */
  readonly standard?: Json | undefined;
  /** Called with `undefined` where the document needs no value: it is empty or the standard. */
  readonly onChange: (value: Json | undefined) => void;
  readonly problems?: readonly PlacedProblem[];
  /** A description in place of that of the schema. */
  readonly description?: string;
}

/** Returns the id of the element that shows the value at a place of a document. */
export function fieldId(pointer: string): string {
  return `field${encodeURI(pointer)}`;
}

/** A value of a document, typed or chosen as its JSON Schema says. */
export function Field(props: FieldProps) {
  const { pointer, schema, definitions = {}, label, value, onChange, problems = [] } = props;
  const whole = resolved(schema, definitions);
  const { look, isNullable, allowed } = lookOf(schema, definitions);
  const standard = props.standard ?? (whole.default as Json | undefined);
  const description = props.description ?? whole.description ?? "";
  const id = fieldId(pointer);
  const change = (next: Json | undefined) => {
    const isStandard = next === undefined || isSame(next, standard ?? null);
    onChange(isStandard ? undefined : next);
  };
  const hasStandard = standard !== undefined && standard !== null;
  const isOwn = value !== undefined && value !== null && hasStandard;
  const control: ControlProps = {
    id,
    value: value ?? standard ?? null,
    isNullable: isNullable && !hasStandard,
    isInvalid: problems.length > 0,
    describedBy: `${id}-about`,
    onChange: change,
  };
  const unit = look.kind === "number" ? look.unit : "";
  const Control = controlFor(look);
  return (
    <div className="field" data-kind={look.kind} data-own={isOwn}>
      <label htmlFor={id}>
        {label}
        {unit && <span className="hidden-visually"> in {unit}</span>}
      </label>
      <span className="control">
        <Control {...control} look={look} />
        {unit && (
          <span className="quiet" aria-hidden="true">
            {unit}
          </span>
        )}
        {isOwn && (
          <button
            type="button"
            className="plain quiet"
            title={`Back to the default: ${textOf(standard)}`}
            aria-label={`${label}: back to ${textOf(standard)}`}
            onClick={() => onChange(undefined)}
          >
            ↺
          </button>
        )}
      </span>
      <div id={`${id}-about`} className="about">
        <About description={description} allowed={allowed} />
        <Problems problems={problems} />
      </div>
    </div>
  );
}

function About({
  description,
  allowed,
}: {
  readonly description: string;
  readonly allowed: string;
}): ReactNode {
  if (!description && !allowed) return null;
  return (
    <p className="quiet">
      <Prose text={description} /> {allowed && <span className="allowed">{sentence(allowed)}</span>}
    </p>
  );
}

function sentence(words: string): string {
  return `${words.charAt(0).toUpperCase()}${words.slice(1)}.`;
}

/** What is wrong with a value, in the words of the service. */
export function Problems({ problems }: { readonly problems: readonly PlacedProblem[] }) {
  return problems.map(({ pointer, message }) => (
    <p key={`${pointer} ${message}`} className="problem">
      <span>
        <Prose text={message} />
      </span>
    </p>
  ));
}

/** The properties of an object, a field each. */
export function Fields({
  pointer,
  properties,
  names = Object.keys(properties),
  labels = {},
  definitions,
  value,
  standards = {},
  problemsOf,
  onChange,
}: {
  /** The place of the object in its document. */
  readonly pointer: string;
  readonly properties: Readonly<Record<string, JsonSchema>>;
  /** Those that are shown, in this order; else all. */
  readonly names?: readonly string[];
  /** Labels by name, where the name of a property does not say what it is on its page. */
  readonly labels?: Readonly<Record<string, string>>;
  readonly definitions?: Definitions;
  readonly value: Readonly<Record<string, Json>>;
  /** What stands where the object has no value, by name; else the default of the schema. */
  readonly standards?: Readonly<Record<string, Json>>;
  readonly problemsOf: (pointer: string) => readonly PlacedProblem[];
  /** Called with the place of what changes. */
  readonly onChange: (pointer: string, value: Json | undefined) => void;
}) {
  return (
    <div className="fields">
      {names.map((name) => {
        const schema = properties[name];
        if (!schema) return null;
        const place = below(pointer, name);
        return (
          <Field
            key={name}
            pointer={place}
            schema={schema}
            {...(definitions ? { definitions } : {})}
            label={labels[name] ?? labelOf(name)}
            value={value[name]}
            standard={standards[name]}
            problems={problemsOf(place)}
            onChange={(next) => onChange(place, next)}
          />
        );
      })}
    </div>
  );
}
