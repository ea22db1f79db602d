import { Field, Fields } from "../../components/fields/Field";
import { propertiesOf } from "../../components/fields/jsonSchema";
import { isObject } from "../../components/fields/pointers";
import { suggestedName } from "./draft";
import type { Form } from "./form";
import { Folded, Section } from "./Section";

const ADVANCED = ["lookahead", "workers"];

/** How much is searched, under which name. */
export function BudgetSection({ form }: { readonly form: Form }) {
  const { kind, draft, set, problemsOf } = form;
  const { definitions } = form.catalogues;
  const whole = kind === "campaign" ? "CampaignDocument" : "StudyDocument";
  const properties = propertiesOf(definitions[whole], definitions);
  const { settings } = draft;
  const shared = {
    pointer: "",
    properties,
    definitions,
    value: settings,
    problemsOf,
    onChange: set,
  };
  return (
    <Section pointer="/budget" title="Budget" problems={problemsOf("/budget")}>
      <div className="fields">
        <Fields
          {...shared}
          pointer="/budget"
          properties={propertiesOf(definitions.BudgetDocument, definitions)}
          value={isObject(settings.budget) ? settings.budget : {}}
        />
        <Fields {...shared} names={kind === "study" ? ["repetitions", "seed"] : ["seed"]} />
      </div>
      {properties.name && (
        <Field
          pointer="/name"
          schema={properties.name}
          definitions={definitions}
          label="Name"
          description=""
          value={settings.name}
          standard={suggestedName(kind, draft)}
          problems={problemsOf("/name")}
          onChange={(value) => set("/name", value)}
        />
      )}
      <Folded
        title="Workers and lookahead"
        hasProblem={ADVANCED.some((name) => problemsOf(`/${name}`).length > 0)}
      >
        <Fields {...shared} names={ADVANCED} />
      </Folded>
    </Section>
  );
}
