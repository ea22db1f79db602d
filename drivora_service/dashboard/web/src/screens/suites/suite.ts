import type { Schemas } from "../../api/client";
import type { configurationFilter } from "../../components/configuration";
import type { MarkLook, Tone } from "../../components/Mark";
import { count, moment } from "../../components/numbers";

export type SuiteRun = Schemas["SuiteRunSummary"];
export type History = Schemas["SuiteHistory"];
export type ScenarioLine = Schemas["ScenarioHistory"];
export type Outcome = Schemas["SuiteOutcome-Output"];
export type ScenarioState = Schemas["ScenarioState"];

/** How the state of a scenario is shown: a sign and a word, so that colour is never needed. */
export const STATES: Readonly<Record<ScenarioState, MarkLook>> = {
  fails_gate: { sign: "✕", tone: "bad", text: "fails the gate" },
  not_judged: { sign: "?", tone: "lost", text: "not judged" },
  flaky: { sign: "~", tone: "lost", text: "flaky" },
  fails: { sign: "◇", tone: "quiet", text: "fails, as accepted" },
  known: { sign: "○", tone: "quiet", text: "known failures only" },
  passes: { sign: "✓", tone: "good", text: "passes" },
};

/** Returns how the decision of a gate is shown. */
export function lookOfGate({ fails }: Pick<SuiteRun, "fails">): MarkLook {
  return fails
    ? { sign: "✕", tone: "bad", text: "gate failed" }
    : { sign: "✓", tone: "good", text: "gate passed" };
}

/** Returns a share as `67 % (39 to 86)`. */
export function shareWords({ mean, low, high }: Schemas["SuiteEstimate-Output"]): string {
  const whole = (share: number) => (100 * share).toFixed(0);
  return low === null || high === null || low === undefined || high === undefined
    ? `${whole(mean)} %`
    : `${whole(mean)} % (${whole(low)} to ${whole(high)})`;
}

/** Returns the ADS of a run of a suite with its parameters. */
export function driverOf({
  agent,
  agent_parameters,
  configuration,
}: Pick<SuiteRun, "agent" | "agent_parameters" | "configuration">) {
  if (configuration) return configuration;
  return [agent || "as in the scenarios", ...agent_parameters].join(", ");
}

/** What tells a run of a suite from the others that are shown with it. */
export interface RunName {
  /** Its ADS, and the versions in which the runs differ. */
  readonly driver: string;
  /** As much of its date and time as tells it from the others. */
  readonly when: string;
  /** The ADS and the whole time. */
  readonly whole: string;
}

/** Returns the names of runs, which differ unless two runs began in the same second. */
export function runNames(
  runs: readonly Pick<
    SuiteRun,
    "agent" | "agent_parameters" | "configuration" | "created_at" | "versions"
  >[],
): readonly RunName[] {
  const times = runs.map(({ created_at }) => moment(created_at));
  const differ = (of: (time: string) => string) => new Set(times.map(of)).size === times.length;
  const days = new Set(times.map((time) => time.slice(0, 10)));
  const end = differ((time) => time.slice(0, 16)) ? 16 : 19;
  const packages = [...new Set(runs.flatMap(({ versions }) => Object.keys(versions)))].filter(
    (name) => new Set(runs.map(({ versions }) => versions[name])).size > 1,
  );
  return runs.map((run, place) => {
    const time = times[place] ?? "";
    const driver = [
      driverOf(run),
      ...packages.map((name) => `${name} ${run.versions[name] ?? "none"}`),
    ].join(", ");
    const isDated = days.size > 1;
    const short = isDated && days.size === times.length ? 10 : end;
    return {
      driver,
      when: time.slice(isDated ? 5 : 11, short),
      whole: `${driver}, ${time.slice(0, end)}`,
    };
  });
}

/**
 * Returns the places of the two runs that are compared, the old and the new one: as asked by their
 * ids, else the last and the one before; the old one is -1 where none is older.
 */
export function comparedRuns(
  asked: { readonly before: string; readonly after: string },
  runs: readonly { readonly id: string }[],
): readonly [number, number] {
  const place = (id: string) => runs.findIndex((run) => run.id === id);
  const named = place(asked.after);
  const after = named > 0 ? named : runs.length - 1;
  const before = place(asked.before);
  return [before >= 0 && before < after ? before : after - 1, after];
}

/** Returns every how many-th of labels is shown, so that they do not touch. */
export function labelStride(labels: readonly string[], apart: number, letter = 7): number {
  const widest = Math.max(0, ...labels.map(({ length }) => length * letter + 8));
  return Math.max(1, Math.ceil(widest / Math.max(apart, 1)));
}

/** Returns how many runs each ADS drove; runs that each scenario's own ADSs drove are left out. */
export function runsByDriver(
  runs: readonly Pick<SuiteRun, "agent">[],
): Readonly<Record<string, number>> {
  const numbers = new Map<string, number>();
  for (const { agent } of runs) if (agent) numbers.set(agent, (numbers.get(agent) ?? 0) + 1);
  return Object.fromEntries(numbers);
}

/** Returns the ADSs with parameters that drove runs, with how many of them each drove. */
export function configurationsOf(
  runs: readonly Pick<SuiteRun, "configuration" | "configuration_id">[],
): Parameters<typeof configurationFilter>[0] {
  const found = new Map<string, { id: string; words: string; runs: number }>();
  for (const { configuration = "", configuration_id: id = "" } of runs) {
    const known = found.get(id);
    if (known) known.runs += 1;
    else if (id) found.set(id, { id, words: configuration, runs: 1 });
  }
  return [...found.values()];
}

/** Returns whether a scenario passed in all runs that had it. */
export function alwaysPasses({ outcomes }: ScenarioLine): boolean {
  return outcomes.every((one) => one === null || one.state === "passes");
}

/** What became of a scenario from one run of its suite to another. */
export type Turn = "better" | "worse" | "other";

const GOOD: ReadonlySet<ScenarioState> = new Set(["passes", "known"]);

/** Returns how a scenario changed between two runs of its suite; undefined where it did not. */
export function turnOf(
  before: Outcome | null | undefined,
  after: Outcome | null | undefined,
): Turn | undefined {
  if (!before || !after || before.state === after.state) return undefined;
  if (GOOD.has(before.state) === GOOD.has(after.state)) return "other";
  return GOOD.has(after.state) ? "better" : "worse";
}

export const TURNS: Readonly<Record<Turn, { readonly words: string; readonly tone: Tone }>> = {
  worse: { words: "fail now and did not", tone: "bad" },
  better: { words: "pass now and did not", tone: "good" },
  other: { words: "fail otherwise", tone: "quiet" },
};

/** Returns the scenarios that changed between two runs of a suite, the worse first. */
export function changesBetween(
  history: History,
  before: number,
  after: number,
): readonly { readonly line: ScenarioLine; readonly turn: Turn }[] {
  const order: readonly Turn[] = ["worse", "other", "better"];
  return history.scenarios
    .flatMap((line) => {
      const turn = turnOf(line.outcomes[before], line.outcomes[after]);
      return turn ? [{ line, turn }] : [];
    })
    .toSorted((a, b) => order.indexOf(a.turn) - order.indexOf(b.turn));
}

/** Returns how a suite stands against a run before, in one sentence. */
export function changeSentence(changes: readonly { readonly turn: Turn }[]): string {
  const of = (turn: Turn) => changes.filter((one) => one.turn === turn).length;
  const parts = (["worse", "better", "other"] as const).flatMap((turn) =>
    of(turn) > 0 ? [`${count(of(turn))} ${TURNS[turn].words}`] : [],
  );
  return parts.length > 0 ? `${parts.join(", ")}.` : "No scenario changed.";
}
