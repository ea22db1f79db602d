import { Fields } from "../../components/fields/Field";
import { propertiesOf } from "../../components/fields/jsonSchema";
import { isObject, valueAt } from "../../components/fields/pointers";
import { parameterSchemas } from "./catalogues";
import type { Form } from "./form";
import { ParameterFields } from "./ParameterFields";
import { Folded } from "./Section";

const OPERATORS = ["feedback", "mutation", "selection"];

/** The parameters of a method, and what can stand in place of its own parts. */
export function TesterSettings({
  form,
  pointer,
}: {
  readonly form: Form;
  readonly pointer: string;
}) {
  const { testers, definitions } = form.catalogues;
  const given = valueAt(form.draft.settings, pointer);
  const value = isObject(given) ? given : {};
  const tester = testers.find(({ name }) => name === value.name);
  const changed = OPERATORS.filter((name) => value[name] !== undefined).length;
  return (
    <>
      {tester && (
        <ParameterFields
          // Another method has other parameters.
          key={tester.name}
          form={form}
          pointer={`${pointer}/parameters`}
          properties={parameterSchemas(tester.parameters)}
        />
      )}
      <Folded
        title="Feedback and operators"
        says={changed > 0 ? `${changed} changed` : ""}
        hasProblem={OPERATORS.some((name) => form.problemsOf(`${pointer}/${name}`).length > 0)}
      >
        <Fields
          pointer={pointer}
          properties={propertiesOf(definitions.TesterDocument, definitions)}
          names={OPERATORS}
          definitions={definitions}
          value={value}
          problemsOf={form.problemsOf}
          onChange={form.set}
        />
      </Folded>
    </>
  );
}
