/** Real runs, campaigns and a study, made by the service itself. */

import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import type { Api } from "./api";
import { ended, REPOSITORY } from "./service";

const EXAMPLES = join(REPOSITORY, "openscenario_schemas", "examples");

const SUITE = "smoke";

/** The same for all campaigns, so that they can be compared. */
const SIMULATIONS = 30;

/** What the tests open: ids of what the service has. */
export interface Made {
  readonly batches: readonly string[];
  /** A batch with collisions for which egos are and are not at fault. */
  readonly collisions: string;
  /** Two batches of the same scenarios, driven by other agents: what was, and what is new. */
  readonly paired: readonly [string, string];
  readonly campaign: string;
  /** It and others, of two methods with two seeds each. */
  readonly compared: readonly string[];
  readonly study: string;
  /** A run in which an ego is at fault. */
  readonly run: string;
  readonly otherRun: string;
  /** A minimisation that has ended, of a run of the campaign. */
  readonly minimization: string;
  /** Name of a suite that two ADSs have driven, which fail in different scenarios. */
  readonly suite: string;
}

interface Posted {
  readonly batch: { readonly id: string };
}
interface Progress {
  readonly state: string;
  readonly done?: boolean;
}
interface Runs {
  readonly items: readonly { readonly id: string; readonly status: string }[];
}

function scenario(...path: string[]): Record<string, unknown> {
  return JSON.parse(readFileSync(join(EXAMPLES, ...path), "utf8")) as Record<string, unknown>;
}

/** Returns the files of scenarios of collisions, of different kinds, from one of them on. */
function collisionFiles(count: number, first = 0): readonly string[] {
  return readdirSync(join(EXAMPLES, "responsibility"))
    .filter((name) => name.endsWith(".json") && name !== "cases.json")
    .sort()
    .filter((_, place, all) => place % Math.floor(all.length / count) === first);
}

function collisions(count: number): readonly Record<string, unknown>[] {
  return collisionFiles(count).map((name) => scenario("responsibility", name));
}

/** Posts the same scenarios with their names twice: as they are, and driven by another agent. */
async function postPaired(api: Api): Promise<readonly [string, string]> {
  // Of these, each of the two drivers has collisions of kinds that the other has not.
  const items = collisionFiles(26, 1).map((name) => ({
    label: name.replace(".json", ""),
    scenario: scenario("responsibility", name),
  }));
  return [
    await postBatch(api, "as scripted", items),
    // One scenario is in the first batch alone.
    await postBatch(api, "candidate", items.slice(1), { agent: "idm" }),
  ];
}

/** Several egos of one ADS meet at an all-way stop: some collide. */
export function meetingCampaign(name: string, simulations: number): Record<string, unknown> {
  return {
    name,
    tester: { name: "doppeltest" },
    agent: { name: "idm" },
    scenario: scenario("campaigns", "orchard-lane.json"),
    space: {
      egos: 5,
      optional: true,
      max_ego_delay: 3.0,
      vehicles: 0,
      walkers: 0,
      weather: false,
    },
    budget: { simulations },
    oracles: ["collision", "near_miss", "deadlock"],
    seed: 1,
  };
}

/** Few and short, so that all of them end within seconds. */
function smallStudy(): Record<string, unknown> {
  return {
    name: "two methods",
    scenarios: [{ document: scenario("campaigns", "market-street.json"), label: "left turn" }],
    agents: [{ name: "idm" }, { name: "idm-mobil" }],
    methods: [{ name: "random" }, { name: "avfuzzer", parameters: { population: 4 } }],
    repetitions: 2,
    space: { vehicles: 3, walkers: 1 },
    oracles: ["collision", "red_light", "off_road"],
    budget: { simulations: 10 },
  };
}

/** Runs a part of the shipped suite as CI does; its gate fails. */
async function runSuite(agent: string, url: string): Promise<void> {
  const words = ["suite", "run", SUITE, "--agent", agent, "--server", url];
  const { code, err } = await ended(...words, "--select", "tee and (near or collision)");
  if (code !== 1) throw new Error(`the suite ended with ${code}: ${err}`);
}

export async function postBatch(
  api: Api,
  name: string,
  scenarios: readonly Record<string, unknown>[],
  overrides: Readonly<Record<string, string>> = {},
): Promise<string> {
  const words = new URLSearchParams({ name, priority: "interactive", ...overrides });
  return (await api.post<Posted>(`/batches?${words}`, scenarios)).batch.id;
}

/** Short scenarios that end well. */
export function shortScenarios(count: number): readonly Record<string, unknown>[] {
  return collisions(count).slice(0, count);
}

/** Scenarios that keep a worker busy for seconds each, and end well. */
export function longScenarios(count: number): readonly Record<string, unknown>[] {
  return Array.from({ length: count }, () => scenario("signalised-grid.json"));
}

export async function makeData(api: Api): Promise<Made> {
  const struck = await postBatch(api, "collisions", collisions(16));
  const examples = await postBatch(api, "examples", [
    scenario("walker-behind-van.json"),
    scenario("three-drivers.json"),
    scenario("signalised-grid.json"),
  ]);
  const paired = await postPaired(api);
  const compared: string[] = [];
  for (const [name, seed] of [
    ["doppeltest", 1],
    ["random", 1],
    ["doppeltest", 2],
    ["random", 2],
  ] as const) {
    const content = meetingCampaign(`meeting at a stop, ${name} ${seed}`, SIMULATIONS);
    const posted = await api.post<{ id: string }>("/campaigns", {
      ...content,
      tester: { name },
      seed,
    });
    compared.push(posted.id);
  }
  const [campaign] = compared;
  if (campaign === undefined) throw new Error("no campaign was posted");
  const study = await api.post<{ id: string }>("/studies", smallStudy());
  for (const batch of [struck, examples, ...paired]) {
    await api.until<Progress>(`/batches/${batch}`, ({ done }) => done === true);
  }
  for (const id of compared) {
    await api.until<Progress>(`/campaigns/${id}`, ({ state }) => state === "finished");
  }
  await api.until<Progress>(`/studies/${study.id}`, ({ state }) => state === "finished");
  const failing = await api.get<Runs>(`/runs?batch=${struck}&at_fault=true&limit=2`);
  const [run, otherRun] = failing.items;
  if (!run || !otherRun) throw new Error("no ego is at fault in the collisions");
  const ofCampaign = await api.get<Runs>(`/runs?campaign=${campaign}&at_fault=true&limit=1`);
  const minimized = ofCampaign.items[0];
  if (!minimized) throw new Error("no ego is at fault in the campaign");
  const { id: minimization } = await api.post<{ id: string }>(`/runs/${minimized.id}:minimize`);
  await api.until<Progress>(`/minimizations/${minimization}`, ({ state }) => state === "finished");
  for (const agent of ["idm", "pdm-closed"]) await runSuite(agent, api.url);
  return {
    batches: [struck, examples],
    collisions: struck,
    paired,
    campaign,
    compared,
    study: study.id,
    run: run.id,
    otherRun: otherRun.id,
    minimization,
    suite: SUITE,
  };
}
