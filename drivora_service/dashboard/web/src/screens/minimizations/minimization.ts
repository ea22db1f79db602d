import type { Schemas } from "../../api/client";
import type { MarkLook } from "../../components/Mark";
import { count, duration, fixed } from "../../components/numbers";

export type Minimization = Schemas["Minimization"];
export type Summary = Schemas["MinimizationSummary"];
type State = Schemas["MinimizationState"];
export type Size = Schemas["ScenarioSize"];

const LOOKS: Readonly<Record<State, MarkLook>> = {
  queued: { sign: "○", tone: "quiet", text: "queued" },
  running: { sign: "▸", tone: "live", text: "running" },
  finished: { sign: "✓", tone: "good", text: "finished" },
  failed: { sign: "⚠", tone: "lost", text: "failed" },
  cancelled: { sign: "–", tone: "quiet", text: "cancelled" },
  interrupted: { sign: "⚠", tone: "lost", text: "interrupted" },
};

/** Returns how the state of a minimisation is shown; a budget that ended too early is no success. */
export function lookOfMinimization({
  state,
  one_minimal,
}: Pick<Summary, "state" | "one_minimal">): MarkLook {
  if (state !== "finished") return LOOKS[state];
  return one_minimal
    ? { ...LOOKS.finished, text: "finished, 1-minimal" }
    : { sign: "◐", tone: "lost", text: "finished, budget ended" };
}

/** Returns whether a minimisation runs, or waits for it. */
export function isActive({ state }: Pick<Summary, "state">): boolean {
  return state === "queued" || state === "running";
}

/** Returns whether a minimisation can be cancelled: an interrupted one could still go on. */
export function mayBeCancelled(minimization: Pick<Summary, "state">): boolean {
  return isActive(minimization) || minimization.state === "interrupted";
}

/** Returns what a minimisation is called: the failure that it follows. */
export function nameOf({ failure }: Pick<Summary, "failure">): string {
  return `${failure.oracle.replaceAll("_", " ")} of ${failure.ego}`;
}

const STAGES: Readonly<Record<string, string>> = {
  "": "waits to begin",
  reproducing: "reproducing the failure",
  actors: "removing actors",
  background: "removing background traffic",
  time: "shortening the time",
  routes: "shortening routes",
  begin: "beginning later",
  settings: "removing settings",
  waypoints: "removing waypoints",
  details: "removing details of actors",
  numbers: "rounding numbers",
  proof: "trying every single reduction",
  confirming: "running the smallest scenario again",
};

/** Returns in words what a minimisation does at a stage. */
export function stageWords(stage: string): string {
  return STAGES[stage] ?? stage.replaceAll("_", " ");
}

/** Returns how much is left of a scenario, in one clause; "" before its failure was reproduced. */
export function leftWords({ before, after }: Pick<Summary, "before" | "after">): string {
  if (!before || !after) return "";
  const actors = `${count(after.actors)} of ${count(before.actors)} actors`;
  return `${actors} and ${count(after.waypoints)} of ${count(before.waypoints)} waypoints`;
}

/** Returns how a minimisation stands, in one sentence. */
export function answerOf(minimization: Summary): string {
  const { state, one_minimal, message } = minimization;
  const left = leftWords(minimization);
  if (state === "queued") return "Waits to begin.";
  if (state === "failed") return `${message.charAt(0).toUpperCase()}${message.slice(1)}.`;
  if (!left)
    return state === "running"
      ? "The scenario is run as it was, to reproduce its failure."
      : "It ended before the failure was reproduced.";
  if (state === "running") return `${left} are left so far.`;
  if (state === "cancelled") return `${left} are left; it was cancelled before its end.`;
  if (state === "interrupted") return `${left} are left; the command that searched has ended.`;
  return one_minimal
    ? `${left} are left; every single reduction was tried.`
    : `${left} are left; the budget ended before every single reduction was tried.`;
}

/** Returns the size of a scenario in one line. */
export function sizeWords(size: Size): string {
  const actors = `${count(size.actors)} ${size.actors === 1 ? "actor" : "actors"}`;
  const routes = `${fixed(size.route_m, 0)} m of routes`;
  return `${actors}, ${count(size.waypoints)} waypoints, ${routes}, ${fixed(size.sim_time_s, 1)} s`;
}

/** A row of the sizes of a scenario before and after. */
export interface SizeRow {
  readonly name: string;
  readonly unit: string;
  readonly before: string;
  readonly after: string;
  /** Share of the size that is left; of nothing, nothing. */
  readonly share: number;
  /** Whether it is a part of the row of all actors. */
  readonly isPart: boolean;
}

const PARTS = [
  ["egos", "egos"],
  ["NPC vehicles", "vehicles"],
  ["walkers", "walkers"],
  ["obstacles", "obstacles"],
  ["background traffic", "background"],
] as const satisfies readonly (readonly [string, keyof Size])[];

const OTHERS = [
  ["slippery patches", "patches", "", 0],
  ["waypoints", "waypoints", "", 0],
  ["settings", "settings", "", 0],
  ["digits of numbers", "digits", "", 0],
  ["routes of egos", "route_m", "m", 1],
  ["simulated time", "sim_time_s", "s", 1],
] as const satisfies readonly (readonly [string, keyof Size, string, number])[];

/** Returns the sizes before and after, named as `drivora minimize` does; without absent actors. */
export function sizeRows(before: Size, after: Size): readonly SizeRow[] {
  const row = (name: string, key: keyof Size, unit = "", digits = 0, isPart = false): SizeRow => {
    const text = (value: number) => (digits > 0 ? fixed(value, digits) : count(value));
    const share = before[key] > 0 ? Math.min(after[key] / before[key], 1) : 0;
    return {
      name,
      unit,
      before: text(before[key]),
      after: text(after[key]),
      share,
      isPart,
    };
  };
  return [
    row("actors", "actors"),
    ...PARTS.filter(([, key]) => before[key] > 0).map(([name, key]) => row(name, key, "", 0, true)),
    ...OTHERS.filter(([, key]) => key !== "patches" || before.patches > 0).map(
      ([name, key, unit, digits]) => row(name, key, unit, digits),
    ),
  ];
}

/** Returns a document as JSON to read: lists of plain values are on one line each. */
export function documentText(document: unknown): string {
  // Within strings there is no line break: what follows one is the layout's.
  const text = JSON.stringify(document, null, 2).replace(
    /\[\n\s*([^[\]{}]*?)\n\s*\]/g,
    (_, values: string) => `[${values.replaceAll(/\n\s*/g, " ")}]`,
  );
  return `${text}\n`;
}

/** Returns the command that searches the same on a service. */
export function minimizeCommand(
  { run_id, failure, budget }: Pick<Summary, "run_id" | "failure" | "budget">,
  server: string,
): string {
  const same = `--oracle ${failure.oracle} --radius ${failure.radius_m} --budget ${budget}`;
  return `drivora minimize ${run_id} ${same} --server ${server} --out smaller`;
}

/** Returns how long a minimisation took, in words; "" before its end. */
export function tookWords({
  started_at,
  ended_at,
}: Pick<Summary, "started_at" | "ended_at">): string {
  if (!started_at || !ended_at) return "";
  return duration((Date.parse(ended_at) - Date.parse(started_at)) / 1000);
}

/** The id of a minimisation's run: its own, a part of the scenario's hash, and why it was run. */
const RUN_ID = /^([0-9a-f]{24})-[0-9a-f]{14}[rtoc]$/;

/** Returns the id of the minimisation that made a run, "" if none did. */
export function minimizationOf(runId: string): string {
  return RUN_ID.exec(runId)?.[1] ?? "";
}
