/** A JSON Schema as far as fields are made from it; `x-unit` is the unit of a number. */
export interface JsonSchema {
  readonly $ref?: string;
  readonly type?: string;
  readonly description?: string;
  readonly default?: unknown;
  readonly enum?: readonly unknown[];
  readonly const?: unknown;
  readonly anyOf?: readonly JsonSchema[];
  readonly minimum?: number;
  readonly maximum?: number;
  readonly exclusiveMinimum?: number;
  readonly exclusiveMaximum?: number;
  readonly minLength?: number;
  readonly maxLength?: number;
  readonly items?: JsonSchema;
  readonly properties?: Readonly<Record<string, JsonSchema>>;
  readonly required?: readonly string[];
  readonly "x-unit"?: string;
}

/** Schemas by name, to which the references of others lead. */
export type Definitions = Readonly<Record<string, JsonSchema>>;

/** How a value is typed or chosen. */
export type Look =
  | {
      readonly kind: "number";
      readonly isWhole: boolean;
      readonly unit: string;
      readonly least: number | undefined;
      readonly most: number | undefined;
    }
  | { readonly kind: "choice"; readonly values: readonly (string | number)[] }
  | { readonly kind: "switch" }
  | { readonly kind: "text"; readonly longest: number | undefined }
  | { readonly kind: "list"; readonly ofNumbers: boolean }
  | { readonly kind: "json" };

export interface FieldLook {
  readonly look: Look;
  /** Whether there may be no value. */
  readonly isNullable: boolean;
  /** What is allowed, in words; "" where the look says it. */
  readonly allowed: string;
}

/** Returns a schema with what its reference leads to; its own keys go before. */
export function resolved(schema: JsonSchema, definitions: Definitions): JsonSchema {
  if (schema.$ref === undefined) return schema;
  const { $ref, ...own } = schema;
  const found = definitions[$ref.slice($ref.lastIndexOf("/") + 1)];
  return found ? { ...resolved(found, definitions), ...own } : own;
}

/** Returns the schemas of the properties of an object by name; none of anything else. */
export function propertiesOf(
  schema: JsonSchema | undefined,
  definitions: Definitions,
): Readonly<Record<string, JsonSchema>> {
  if (!schema) return {};
  const whole = resolved(schema, definitions);
  if (whole.properties) return whole.properties;
  const choice = whole.anyOf?.find((one) => resolved(one, definitions).properties);
  return choice ? propertiesOf(choice, definitions) : {};
}

/** Returns how the values of a schema are typed or chosen. */
export function lookOf(schema: JsonSchema, definitions: Definitions = {}): FieldLook {
  const whole = resolved(schema, definitions);
  const choices = whole.anyOf?.map((one) => resolved(one, definitions));
  if (!choices) return { look: plainLook(whole), isNullable: false, allowed: allowedWords(whole) };
  const others = choices.filter(({ type }) => type !== "null");
  const isNullable = others.length < choices.length;
  const [only] = others;
  const allowed = others.map(allowedWords).filter(Boolean).join(", or ");
  if (others.length === 1 && only) return { look: plainLook(only), isNullable, allowed };
  return { look: { kind: "json" }, isNullable, allowed };
}

function plainLook(schema: JsonSchema): Look {
  const values = schema.enum ?? (schema.const === undefined ? undefined : [schema.const]);
  if (values?.every((value) => typeof value === "string" || typeof value === "number"))
    return { kind: "choice", values: values as readonly (string | number)[] };
  switch (schema.type) {
    case "number":
    case "integer":
      return {
        kind: "number",
        isWhole: schema.type === "integer",
        unit: unitOf(schema),
        least: schema.minimum ?? schema.exclusiveMinimum,
        most: schema.maximum ?? schema.exclusiveMaximum,
      };
    case "boolean":
      return { kind: "switch" };
    case "string":
      return { kind: "text", longest: schema.maxLength };
    case "array": {
      const items = schema.items?.type;
      if (items === "string" || items === "number" || items === "integer")
        return { kind: "list", ofNumbers: items !== "string" };
      return { kind: "json" };
    }
    default:
      return { kind: "json" };
  }
}

/** Returns the unit of a number; "" of a number without one. */
export function unitOf(schema: JsonSchema): string {
  const unit = schema["x-unit"] ?? "";
  return unit === "1" ? "" : unit;
}

const digits = new Intl.NumberFormat("en", { maximumFractionDigits: 6 });

/** Returns the bounds of a number or of the length of a text, in words. */
export function allowedWords(schema: JsonSchema): string {
  const { type, minimum, maximum, exclusiveMinimum, exclusiveMaximum } = schema;
  if (type === "integer" || type === "number") {
    const whole = type === "integer" ? "whole number" : "number";
    if (minimum !== undefined && maximum !== undefined)
      return `${digits.format(minimum)} to ${digits.format(maximum)}`;
    const bound = (word: string, value: number | undefined) =>
      value === undefined ? "" : `${word} ${digits.format(value)}`;
    const bounds = [
      bound("at least", minimum),
      bound("above", exclusiveMinimum),
      bound("at most", maximum),
      bound("below", exclusiveMaximum),
    ].filter(Boolean);
    return bounds.length > 0 ? bounds.join(" and ") : `any ${whole}`;
  }
  if (type === "array") return schema.items?.type ? "separated by commas" : "";
  return "";
}

/** Returns the name of a property as a label: `max_speed_factor` as `Max speed factor`. */
export function labelOf(name: string): string {
  const words = name.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** Returns the defaults of an object's properties by name; those without one are left out. */
export function defaultsOf(
  properties: Readonly<Record<string, JsonSchema>>,
): Readonly<Record<string, unknown>> {
  return Object.fromEntries(
    Object.entries(properties)
      .filter(([, schema]) => schema.default !== undefined && schema.default !== null)
      .map(([name, schema]) => [name, schema.default]),
  );
}
