import { Fields } from "../../components/fields/Field";
import type { JsonSchema } from "../../components/fields/jsonSchema";
import { isObject, valueAt } from "../../components/fields/pointers";
import type { Form } from "./form";
import { Folded } from "./Section";

/** The parameters of an ADS or a method, folded. */
export function ParameterFields({
  form,
  pointer,
  properties,
}: {
  readonly form: Form;
  readonly pointer: string;
  readonly properties: Readonly<Record<string, JsonSchema>>;
}) {
  const given = valueAt(form.draft.settings, pointer);
  const value = isObject(given) ? given : {};
  const changed = Object.keys(value).length;
  const all = Object.keys(properties).length;
  if (all === 0) return null;
  return (
    <Folded
      title="Parameters"
      says={changed > 0 ? `${changed} of ${all} changed` : `${all}`}
      hasProblem={form.problemsOf(pointer, { inside: true }).length > 0}
    >
      <Fields
        pointer={pointer}
        properties={properties}
        value={value}
        problemsOf={form.problemsOf}
        onChange={form.set}
      />
    </Folded>
  );
}
