import type { Schemas } from "../../api/client";

export type Agent = Schemas["Agent"];
export type Parameter = Schemas["AgentParameter"];

/** Returns the values that a parameter may have, in words, from their JSON Schema. */
export function valuesInWords(values: Readonly<Record<string, unknown>>): string {
  const {
    type,
    enum: allowed,
    minimum,
    maximum,
    exclusiveMinimum,
    exclusiveMaximum,
    anyOf,
  } = values;
  if (Array.isArray(allowed)) return allowed.map((value) => JSON.stringify(value)).join(", ");
  if (Array.isArray(anyOf)) return anyOf.map(valuesInWords).join(", or ");
  if (type === "boolean") return "true or false";
  if (type === "null") return "none";
  const least = bound(minimum, "≥ ") || bound(exclusiveMinimum, "> ");
  const most = bound(maximum, "≤ ") || bound(exclusiveMaximum, "< ");
  const kind = type === "integer" ? "whole number" : String(type ?? "any value");
  if (minimum !== undefined && maximum !== undefined)
    return `${type === "integer" ? "whole number, " : ""}${minimum} to ${maximum}`;
  return [kind === "string" ? "text" : kind, least, most].filter(Boolean).join(" ");
}

function bound(value: unknown, sign: string): string {
  return typeof value === "number" ? `${sign}${value}` : "";
}

/** A property by which agents are compared. */
export interface Property {
  readonly name: string;
  readonly values: readonly string[];
  readonly differs: boolean;
}

/** Returns the properties of agents side by side: those that differ first. */
export function compared(agents: readonly Agent[]): readonly Property[] {
  const parameters = [
    ...new Set(agents.flatMap((agent) => (agent.parameters ?? []).map(({ name }) => name))),
  ];
  const rows: readonly (readonly [string, (agent: Agent) => string])[] = [
    ["Kind", (agent) => agent.kind],
    ["Perception", perceptionOf],
    ["Usable here", (agent) => (agent.installed ? "yes" : "no")],
    ["Version", (agent) => agent.version],
    ["Licence", (agent) => agent.licence],
    ["Source", (agent) => agent.source],
    ["Description", (agent) => agent.description],
    ...parameters.map(
      (name) =>
        [
          `Parameter ${name}`,
          (agent: Agent) => {
            const found = (agent.parameters ?? []).find((item) => item.name === name);
            return found
              ? `${JSON.stringify(found.default)} (${valuesInWords(found.values)})`
              : "not a parameter";
          },
        ] as const,
    ),
  ];
  return rows
    .map(([name, told]) => {
      const values = agents.map(told);
      return { name, values, differs: new Set(values).size > 1 };
    })
    .toSorted((a, b) => Number(b.differs) - Number(a.differs));
}

/** Returns what an agent gets to see, in words. */
export function perceptionOf(agent: Agent): string {
  return agent.privileged ? "privileged: sees the true state" : "through the perception model";
}
