import { useQuery } from "@tanstack/react-query";
import { firstOf, type Search, stringifySearch, valuesOf } from "../../address";
import { api, body } from "../../api/client";
import { isObject, type JsonObject } from "../../components/fields/pointers";
import { type FoundScenario, type Kind, type SeedScenario, withScenario } from "./draft";
import { townOf } from "./scenarioWords";

/** Under which another screen leaves a scenario, as JSON text, before it opens a form. */
export const HANDED_OVER = "drivora:scenario";

/** Under which it leaves the scenario's name and the run that was edited, as JSON text. */
export const HANDED_OVER_FROM = "drivora:scenario-from";

/** What a form begins with, by its address. */
export interface Beginning {
  /** Stands for it: what was composed from the same beginning before is shown again. */
  readonly source: string;
  readonly scenarios: readonly SeedScenario[];
  /** A stored document that the form begins with, and what its only scenario is called. */
  readonly stored?: { readonly document: JsonObject; readonly label: string };
  /** Why the scenario of the address could not be read. */
  readonly refusal?: string;
}

type Found = Omit<Beginning, "source">;
/** Reads what the address names: runs, an evaluation, a campaign, a study, or a handed scenario. */
export function useBeginning(kind: Kind, search: Search) {
  const isHanded = firstOf(search, "from") === "author";
  const handed = isHanded ? (sessionStorage.getItem(HANDED_OVER) ?? "") : "";
  const from = isHanded ? (sessionStorage.getItem(HANDED_OVER_FROM) ?? "") : "";
  return useQuery({
    queryKey: ["beginning", kind, stringifySearch(search), handed, from],
    queryFn: async (): Promise<Beginning> => ({
      source: `${kind}${stringifySearch(search)} ${handed}`,
      ...(await found(kind, search, handed, from)),
    }),
    gcTime: 0,
  });
}

async function found(kind: Kind, search: Search, handed: string, from: string): Promise<Found> {
  const runs = valuesOf(search, "run");
  const campaign = firstOf(search, "campaign");
  const evaluation = firstOf(search, "evaluation");
  const study = firstOf(search, "study");
  if (firstOf(search, "from") === "author") return handedOver(handed, from);
  if (runs.length > 0) return { scenarios: together(await Promise.all(runs.map(ofRun))) };
  if (campaign && evaluation)
    return { scenarios: together([await ofEvaluation(campaign, evaluation)]) };
  if (campaign && kind === "campaign") return { scenarios: [], stored: await ofCampaign(campaign) };
  if (study && kind === "study") return { scenarios: [], stored: await ofStudy(study) };
  return { scenarios: [] };
}

function together(added: readonly FoundScenario[]): readonly SeedScenario[] {
  return added.reduce<readonly SeedScenario[]>(withScenario, []);
}

/** Reads the scenario that a run has driven. */
export async function ofRun(id: string): Promise<FoundScenario> {
  const params = { path: { run_id: id } };
  const [run, scenario] = await Promise.all([
    api.GET("/api/v1/runs/{run_id}", { params }),
    api.GET("/api/v1/runs/{run_id}/scenario", { params }),
  ]);
  const document = body(scenario) as unknown as JsonObject;
  const { label, town, definition } = body(run);
  return {
    label: label || town,
    origin: `of run ${id}`,
    document,
    run: id,
    definition,
  };
}

/** Reads the scenario of an evaluation. */
export async function ofEvaluation(campaign: string, evaluation: string): Promise<FoundScenario> {
  const params = { path: { campaign_id: campaign, number: Number(evaluation) } };
  const path = "/api/v1/campaigns/{campaign_id}/evaluations/{number}/scenario";
  const [searched, scenario] = await Promise.all([
    api.GET("/api/v1/campaigns/{campaign_id}", { params: { path: { campaign_id: campaign } } }),
    api.GET(path, { params }),
  ]);
  const document = body(scenario) as unknown as JsonObject;
  return {
    label: `${townOf(document)} ${evaluation}`,
    origin: `of evaluation ${evaluation} of a campaign`,
    document,
    run: `${campaign}-${evaluation}`,
    definition: body(searched).definition,
  };
}

async function ofCampaign(id: string) {
  const { document, cell, town, name } = body(
    await api.GET("/api/v1/campaigns/{campaign_id}", { params: { path: { campaign_id: id } } }),
  );
  return {
    document: { ...(document as JsonObject), name: again(name) },
    label: cell?.scenario ?? town,
  };
}

async function ofStudy(id: string) {
  const { document, name } = body(
    await api.GET("/api/v1/studies/{study_id}", { params: { path: { study_id: id } } }),
  );
  return { document: { ...(document as JsonObject), name: again(name) }, label: "" };
}

const LONGEST = 100;

/** Returns a name for what is searched again with other settings. */
function again(name: string): string {
  return /, again( \d+)?$/.test(name) ? name : `${name.slice(0, LONGEST - 7)}, again`;
}

async function handedOver(text: string, from: string): Promise<Found> {
  const document = parsed(text);
  if (!isObject(document))
    return {
      scenarios: [],
      refusal: "The author screen has left no scenario in this tab. Open it and choose Vary again.",
    };
  const about = parsed(from);
  const { label, run } = isObject(about) ? about : {};
  const authored = townOf(document) ? `${townOf(document)}, authored` : "authored";
  const scenario: FoundScenario = {
    label: typeof label === "string" && label ? label : authored,
    origin: "of the author screen",
    document,
  };
  const edited =
    typeof run === "string" && run ? await ofRun(run).catch(() => undefined) : undefined;
  return {
    scenarios: together([
      edited ? { ...scenario, run: edited.run, definition: edited.definition } : scenario,
    ]),
  };
}

function parsed(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    return undefined;
  }
}
