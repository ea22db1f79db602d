import { Fields, fieldId, Problems } from "../../components/fields/Field";
import { propertiesOf } from "../../components/fields/jsonSchema";
import { isObject, valueAt } from "../../components/fields/pointers";
import { presetOptions } from "./catalogues";
import type { Form } from "./form";
import { Folded, Section } from "./Section";
import { spaceStandards } from "./stored";

/** What varies most often; all else is folded. */
const FIRST = [
  "vehicles",
  "walkers",
  "obstacles",
  "patches",
  "egos",
  "weather",
  "lights",
  "optional",
];

/** The form has other fields with the names of these properties. */
const LABELS = { name: "Space of a package", parameters: "Parameters of that space" };

/** What varies: a named space, and what differs from it. */
export function SpaceSection({ form }: { readonly form: Form }) {
  const { definitions, presets } = form.catalogues;
  const given = valueAt(form.draft.settings, "/space");
  const space = isObject(given) ? given : {};
  const name = typeof space.preset === "string" ? space.preset : "default";
  const preset = presets.find((one) => one.name === name);
  const { preset: _, ...properties } = propertiesOf(definitions.SpaceDocument, definitions);
  const rest = Object.keys(properties).filter((one) => !FIRST.includes(one));
  const changed = rest.filter((one) => space[one] !== undefined).length;
  const shared = {
    pointer: "/space",
    properties,
    definitions,
    value: space,
    standards: spaceStandards(space.preset, definitions, presetOptions(presets)),
    problemsOf: form.problemsOf,
    onChange: form.set,
  };
  const choose = (chosen: string) =>
    form.set("/space", chosen === "default" ? undefined : { preset: chosen });
  return (
    <Section
      pointer="/space"
      title="What varies"
      says="beside the scenario, which stays"
      problems={form.problemsOf("/space")}
    >
      <div className="preset">
        <label className="one">
          Named space
          <select
            id={fieldId("/space/preset")}
            value={name}
            onChange={({ target }) => choose(target.value)}
          >
            {presets.map((one) => (
              <option key={one.name}>{one.name}</option>
            ))}
          </select>
        </label>
        {preset && (
          <span className="quiet" title={preset.source}>
            {preset.description}
          </span>
        )}
        <Problems problems={form.problemsOf("/space/preset")} />
      </div>
      <Fields {...shared} names={FIRST} />
      <Folded
        title="More of the space"
        says={changed > 0 ? `${changed} of ${rest.length} changed` : `${rest.length}`}
        hasProblem={rest.some((one) => form.problemsOf(`/space/${one}`).length > 0)}
      >
        <Fields {...shared} names={rest} labels={LABELS} />
      </Folded>
    </Section>
  );
}
