import type { ReactNode } from "react";
import { Field, fieldId, Problems } from "../../components/fields/Field";
import { propertiesOf } from "../../components/fields/jsonSchema";
import { valueAt } from "../../components/fields/pointers";
import { Prose } from "../../components/Prose";
import type { Form } from "./form";
import { Folded } from "./Section";

/** An ADS or a method of a study: what it is, its settings, and its name in the study. */
export function PartRow({
  form,
  pointer,
  schema,
  title,
  description,
  standard,
  children,
}: {
  readonly form: Form;
  readonly pointer: string;
  /** Name of the schema of the row. */
  readonly schema: string;
  readonly title: string;
  readonly description: string;
  /** Its name in the study if it is given none. */
  readonly standard: string;
  readonly children: ReactNode;
}) {
  const { definitions } = form.catalogues;
  const { label } = propertiesOf(definitions[schema], definitions);
  const given = valueAt(form.draft.settings, `${pointer}/label`);
  const problems = form.problemsOf(`${pointer}/label`);
  return (
    <li id={fieldId(pointer)} tabIndex={-1}>
      <div className="head">
        <h3 id={fieldId(`${pointer}/name`)} tabIndex={-1}>
          {title}
        </h3>
        <span className="quiet">
          <Prose text={description} />
        </span>
        <button
          type="button"
          aria-label={`Remove ${title}`}
          onClick={() => form.set(pointer, undefined)}
        >
          Remove
        </button>
      </div>
      <Problems problems={form.problemsOf(pointer)} />
      <Problems problems={form.problemsOf(`${pointer}/name`)} />
      {children}
      {label && (
        <Folded
          title="Label"
          says={typeof given === "string" ? given : standard}
          hasProblem={problems.length > 0}
        >
          <Field
            pointer={`${pointer}/label`}
            schema={label}
            definitions={definitions}
            label="Label"
            value={given}
            standard={standard}
            problems={problems}
            onChange={(value) => form.set(`${pointer}/label`, value)}
          />
        </Folded>
      )}
    </li>
  );
}
