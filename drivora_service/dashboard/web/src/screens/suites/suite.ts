import type { Schemas } from "../../api/client";
import type { MarkLook, Tone } from "../../components/Mark";
import { count } from "../../components/numbers";

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
}: Pick<SuiteRun, "agent" | "agent_parameters">) {
  return [agent || "as in the scenarios", ...agent_parameters].join(", ");
}

/** Returns how many runs each ADS drove; runs that each scenario's own ADSs drove are left out. */
export function runsByDriver(
  runs: readonly Pick<SuiteRun, "agent">[],
): Readonly<Record<string, number>> {
  const numbers = new Map<string, number>();
  for (const { agent } of runs) if (agent) numbers.set(agent, (numbers.get(agent) ?? 0) + 1);
  return Object.fromEntries(numbers);
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
