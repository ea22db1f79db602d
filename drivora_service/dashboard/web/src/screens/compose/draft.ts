import { type Json, type JsonObject, valueAt, withValue } from "../../components/fields/pointers";
import type { Defined } from "./counting";

/** A scenario from which a search begins. */
export interface SeedScenario {
  readonly id: string;
  readonly label: string;
  /** Where it is from, in words. */
  readonly origin: string;
  readonly document: JsonObject;
  /** Its own variable parts, in a study. */
  readonly space?: JsonObject | undefined;
  /** The id of the run that drove it. */
  readonly run?: string | undefined;
  /** What was defined as a failure for this run. */
  readonly definition?: Defined | undefined;
}

/** A scenario before it has its place in a form. */
export type FoundScenario = Omit<SeedScenario, "id">;

/** What a form holds: the seed scenarios, and the document without them and without defaults. */
export interface Draft {
  readonly scenarios: readonly SeedScenario[];
  readonly settings: JsonObject;
}

export type Kind = "campaign" | "study";

const SIMULATIONS = 200;
const LONGEST_LABEL = 100;
const LONGEST_NAME = 200;

/** The order in which a document is read best: what was chosen first, the long scenarios last. */
const ORDER = [
  "name",
  "tester",
  "agent",
  "methods",
  "agents",
  "repetitions",
  "space",
  "budget",
  "counts",
  "oracles",
  "seed",
  "workers",
  "lookahead",
];

/** Returns the draft that a form begins with. */
export function emptyDraft(kind: Kind): Draft {
  const budget = { simulations: SIMULATIONS };
  const settings: JsonObject =
    kind === "campaign"
      ? { tester: { name: "random" }, budget }
      : { methods: [{ name: "random" }], repetitions: 3, budget };
  return { scenarios: [], settings };
}

/** Returns the document of a draft; what is the default is left out. */
export function documentOf(kind: Kind, draft: Draft): JsonObject {
  const { scenarios } = draft;
  const settings: JsonObject = { ...draft.settings, name: nameOf(kind, draft) };
  const names = [...ORDER, ...Object.keys(settings).filter((name) => !ORDER.includes(name))];
  const chosen = names
    .map((name) => [name, settings[name]] as const)
    .filter((one): one is [string, Json] => one[1] !== undefined)
    // Without ADSs, they are those of the scenarios.
    .filter(([name, value]) => name !== "agents" || !isEmptyList(value));
  return { ...Object.fromEntries(chosen), ...scenarioPart(kind, scenarios) };
}

/** Returns whether a value is a list without items. */
export function isEmptyList(value: Json): boolean {
  return Array.isArray(value) && value.length === 0;
}

function scenarioPart(kind: Kind, scenarios: readonly SeedScenario[]): JsonObject {
  const [only] = scenarios;
  if (kind === "study")
    return {
      scenarios: scenarios.map(({ label, document, space }) => ({
        label,
        ...(space ? { space } : {}),
        document,
      })),
    };
  if (!only) return {};
  if (scenarios.length === 1) return { scenario: only.document };
  return {
    scenarios: scenarios.map(({ label, document }) => ({ name: label, scenario: document })),
  };
}

/** Returns the place of a seed scenario in the document. */
export function scenarioPointer(kind: Kind, count: number, place: number): string {
  return kind === "campaign" && count === 1 ? "/scenario" : `/scenarios/${place}`;
}

/** Returns the name of a draft: the typed one, or that of what it searches. */
export function nameOf(kind: Kind, { scenarios, settings }: Draft): string {
  const typed = settings.name;
  return typeof typed === "string" ? typed : suggestedName(kind, { scenarios, settings });
}

/** Returns a name from the scenarios and the methods. */
export function suggestedName(kind: Kind, { scenarios, settings }: Draft): string {
  const [only] = scenarios;
  const what = !only ? kind : scenarios.length === 1 ? only.label : `${scenarios.length} scenarios`;
  const methods = settings.methods;
  const how = Array.isArray(methods)
    ? methods.map((method: Json) => valueAt(method, "/name")).join(" and ")
    : valueAt(settings, "/tester/name");
  const longest = kind === "study" ? LONGEST_LABEL : LONGEST_NAME;
  return labelled(`${what}, ${how}`, longest);
}

/** Returns a text on one line, without blanks at its ends, as labels have to be. */
export function labelled(text: string, longest = LONGEST_LABEL): string {
  return text
    .replace(/[\s\p{C}]+/gu, " ")
    .trim()
    .slice(0, longest)
    .trim();
}

/** Returns scenarios with another at the end, whose label no other has. */
export function withScenario(
  scenarios: readonly SeedScenario[],
  added: FoundScenario,
): readonly SeedScenario[] {
  const taken = new Set(scenarios.map(({ label }) => label));
  const wanted = labelled(added.label) || "scenario";
  let label = wanted;
  for (let number = 2; taken.has(label); number++)
    label = `${wanted.slice(0, LONGEST_LABEL - 6)} ${number}`;
  const ids = scenarios.map(({ id }) => Number(id));
  return [...scenarios, { ...added, label, id: String(Math.max(0, ...ids) + 1) }];
}

/** Returns rows with another at the end, with a label of its own if its name is taken. */
export function withRow(rows: readonly Json[], name: string): readonly JsonObject[] {
  const taken = new Set(rows.map((row) => valueAt(row, "/label") ?? valueAt(row, "/name")));
  let label = name;
  for (let number = 2; taken.has(label); number++) label = labelled(`${name} ${number}`);
  const added = label === name ? { name } : { name, label };
  return [...(rows as readonly JsonObject[]), added];
}

/** Returns a draft with another value at a place of its settings. */
export function withSetting(draft: Draft, pointer: string, value: Json | undefined): Draft {
  return { ...draft, settings: withValue(draft.settings, pointer, value) };
}
