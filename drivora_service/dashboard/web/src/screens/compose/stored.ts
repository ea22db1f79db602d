import {
  type Definitions,
  defaultsOf,
  type JsonSchema,
  propertiesOf,
} from "../../components/fields/jsonSchema";
import { isObject, type Json, type JsonObject, valueAt } from "../../components/fields/pointers";
import { isSame } from "../../components/fields/typed";
import { type Draft, isEmptyList, type Kind, type SeedScenario, withScenario } from "./draft";
import { townOf } from "./scenarioWords";

/** Options of a named space, by its name. */
export type Presets = ReadonlyMap<string, JsonObject>;

/** Returns the draft of a stored campaign or study, as a form shows it. */
export function draftOf(
  kind: Kind,
  document: JsonObject,
  { definitions, presets, label }: { definitions: Definitions; presets: Presets; label: string },
): Draft {
  const { scenario, scenarios: several, version: _, ...settings } = document;
  let scenarios: readonly SeedScenario[] = [];
  const origin = kind === "campaign" ? "of the campaign" : "of the study";
  if (isObject(scenario))
    scenarios = withScenario(scenarios, { label, origin, document: scenario });
  for (const one of Array.isArray(several) ? (several as readonly Json[]) : []) {
    const content = valueAt(one, kind === "study" ? "/document" : "/scenario");
    const space = valueAt(one, "/space");
    const name = valueAt(one, kind === "study" ? "/label" : "/name");
    if (!isObject(content)) continue;
    scenarios = withScenario(scenarios, {
      label: typeof name === "string" ? name : townOf(content),
      origin,
      document: content,
      space: isObject(space) ? chosenSpace(space, definitions, presets) : undefined,
    });
  }
  const whole = definitions[kind === "campaign" ? "CampaignDocument" : "StudyDocument"];
  const properties = propertiesOf(whole, definitions);
  const reduced = Object.entries(withoutDefaults(settings, defaultsOf(properties))).map(
    ([name, value]) => [name, chosen(value, properties[name], definitions, presets)] as const,
  );
  return { scenarios, settings: withoutEmpty(Object.fromEntries(reduced)) };
}

/** Returns a part of a document without what is the default. */
function chosen(
  value: Json,
  schema: JsonSchema | undefined,
  definitions: Definitions,
  presets: Presets,
): Json {
  if (Array.isArray(value)) {
    const items = schema?.items;
    return value.map((item: Json) =>
      isObject(item) ? chosen(item, items, definitions, presets) : item,
    );
  }
  if (!isObject(value)) return value;
  const properties = propertiesOf(schema, definitions);
  if ("preset" in properties) return chosenSpace(value, definitions, presets);
  return withoutEmpty(withoutDefaults(value, defaultsOf(properties)));
}

function chosenSpace(space: JsonObject, definitions: Definitions, presets: Presets): JsonObject {
  const { preset, ...options } = space;
  const kept = withoutDefaults(options, spaceStandards(preset, definitions, presets));
  return typeof preset === "string" ? { preset, ...kept } : kept;
}

/** Returns the values of a space that stand where none is given: of the preset, or the defaults. */
export function spaceStandards(
  preset: Json | undefined,
  definitions: Definitions,
  presets: Presets,
): JsonObject {
  const defaults = defaultsOf(propertiesOf(definitions.SpaceDocument, definitions)) as JsonObject;
  return { ...defaults, ...(typeof preset === "string" ? presets.get(preset) : {}) };
}

function withoutDefaults(
  values: JsonObject,
  defaults: Readonly<Record<string, unknown>>,
): JsonObject {
  return Object.fromEntries(
    Object.entries(values).filter(
      ([name, value]) => value !== null && !isSame(value, (defaults[name] as Json) ?? null),
    ),
  );
}

function withoutEmpty(values: JsonObject): JsonObject {
  return Object.fromEntries(
    Object.entries(values).filter(
      ([, value]) => !(isObject(value) && Object.keys(value).length === 0) && !isEmptyList(value),
    ),
  );
}
