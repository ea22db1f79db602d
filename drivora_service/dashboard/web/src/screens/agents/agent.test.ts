import { describe, expect, it } from "vitest";
import { type Agent, compared, valuesInWords } from "./agent";

const agent = (part: Partial<Agent>) =>
  ({
    name: "a",
    kind: "baseline",
    licence: "Apache-2.0",
    parameters: [],
    installed: true,
    ...part,
  }) as Agent;

describe("agents", () => {
  it("have parameters whose values are said in words", () => {
    expect(valuesInWords({ type: "number", minimum: 0.1, maximum: 2 })).toBe("0.1 to 2");
    expect(valuesInWords({ type: "integer", minimum: 1, maximum: 9 })).toBe("whole number, 1 to 9");
    expect(valuesInWords({ type: "number", exclusiveMinimum: 0 })).toBe("number > 0");
    expect(valuesInWords({ enum: ["a", "b"] })).toBe('"a", "b"');
    expect(valuesInWords({ anyOf: [{ type: "string" }, { type: "null" }] })).toBe("text, or none");
  });
  it("are compared with what differs first, a missing parameter included", () => {
    const parameter = { name: "speed", default: 1, values: {}, description: "" };
    const rows = compared([agent({ parameters: [parameter] }), agent({ kind: "end-to-end" })]);
    expect(rows.filter(({ differs }) => differs).map(({ name }) => name)).toEqual([
      "Kind",
      "Parameter speed",
    ]);
    expect(rows[1]?.values).toEqual(["1 (any value)", "not a parameter"]);
    expect(rows.at(-1)?.differs).toBe(false);
  });
});
