import { expect, it } from "vitest";
import { allowedWords, defaultsOf, labelOf, lookOf, propertiesOf, resolved } from "./jsonSchema";

const definitions = {
  RouteEnd: { type: "string", enum: ["leave", "stay"], description: "At its end." },
  Budget: { type: "object", properties: { simulations: { type: "integer", minimum: 1 } } },
};
const reference = (name: string) => ({ $ref: `#/components/schemas/${name}` });

it("a reference leads to its schema, and what is said beside it goes before", () => {
  const schema = { ...reference("RouteEnd"), default: "leave", description: "What it does." };
  expect(resolved(schema, definitions)).toEqual({
    type: "string",
    enum: ["leave", "stay"],
    default: "leave",
    description: "What it does.",
  });
  expect(lookOf(schema, definitions).look).toEqual({ kind: "choice", values: ["leave", "stay"] });
});

it("a number has its unit and bounds, and none for a unit of 1", () => {
  const speed = { type: "number", minimum: 0, exclusiveMaximum: 20, "x-unit": "m/s" };
  expect(lookOf(speed)).toEqual({
    look: { kind: "number", isWhole: false, unit: "m/s", least: 0, most: 20 },
    isNullable: false,
    allowed: "at least 0 and below 20",
  });
  const count = { type: "integer", minimum: 0, maximum: 64, "x-unit": "1" };
  expect(lookOf(count)).toMatchObject({ look: { isWhole: true, unit: "" }, allowed: "0 to 64" });
  expect(allowedWords({ type: "integer" })).toBe("any whole number");
  const simulations = { type: "integer", minimum: 1, maximum: 1_000_000 };
  expect(allowedWords(simulations)).toBe("1 to 1,000,000");
});

it("a value that may be null is that of its other choice", () => {
  const nullable = (one: object) => ({ anyOf: [one, { type: "null" }], default: null });
  expect(lookOf(nullable({ type: "boolean" }))).toMatchObject({
    look: { kind: "switch" },
    isNullable: true,
  });
  expect(lookOf(nullable(reference("RouteEnd")), definitions)).toMatchObject({
    look: { kind: "choice" },
    isNullable: true,
  });
  expect(lookOf({ anyOf: [{ type: "integer" }, { type: "string" }] }).look.kind).toBe("json");
});

it("lists of plain values are typed with commas, others as JSON", () => {
  const list = (items: object) => lookOf({ type: "array", items }).look;
  expect(list({ type: "string" })).toEqual({ kind: "list", ofNumbers: false });
  expect(list({ type: "number" })).toEqual({ kind: "list", ofNumbers: true });
  expect(list({ type: "array" })).toEqual({ kind: "json" });
});

it("properties are found behind references and beside null", () => {
  expect(Object.keys(propertiesOf(reference("Budget"), definitions))).toEqual(["simulations"]);
  const nullable = { anyOf: [reference("Budget"), { type: "null" }] };
  expect(Object.keys(propertiesOf(nullable, definitions))).toEqual(["simulations"]);
  expect(propertiesOf(undefined, definitions)).toEqual({});
});

it("defaults leave out what has none", () => {
  const properties = { seed: { default: 0 }, workers: { default: null }, name: {} };
  expect(defaultsOf(properties)).toEqual({ seed: 0 });
});

it("labels are words", () => {
  expect(labelOf("max_speed_factor")).toBe("Max speed factor");
});
