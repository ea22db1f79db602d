import { firstOf, type Search } from "../../address";
import type { Schemas } from "../../api/client";
import { configurationFilter } from "../../components/configuration";
import type { Filter } from "../../components/filterValues";
import { NOT_JUDGED, STATUS_WORDS } from "./status";

type Counts = Schemas["RunCounts"];

/** Degrees of accountability as the reports name them, the strongest first. */
export const ACCOUNTABILITY_WORDS: Readonly<Record<Schemas["Accountability"], string>> = {
  avoidable: "at fault, avoidable",
  not_measurable: "at fault, avoidability not measurable",
  unavoidable: "at fault, not avoidable",
  undetermined: "fault undetermined",
  not_judged: "fault not judged",
  preventable: "not at fault, but avoidable",
  not_at_fault: "not at fault",
};

/** Returns the filters of the list of runs; counts are those that each other value would give. */
export function runFilters(
  counts: Counts | undefined,
  names: Names,
  search: Search,
): readonly Filter[] {
  return [
    {
      name: "status",
      title: "Status",
      values: Object.keys(STATUS_WORDS),
      words: STATUS_WORDS,
      counts: counts?.status,
    },
    {
      name: "violated",
      title: "Violations",
      values: ["true", "false"],
      words: { true: "with a violation", false: "passed" },
      single: true,
      counts: counts && { true: counts.violated, false: counts.not_violated },
    },
    {
      name: "failing",
      title: "Failures",
      values: ["true", "false"],
      words: { true: "with a failure", false: "without one" },
      single: true,
      counts: counts && { true: counts.failing, false: counts.not_failing },
      hint: "By what the suite, campaign or request of a run defined as a failure",
    },
    {
      name: "oracle",
      title: "Oracle",
      single: true,
      counts: counts?.oracle ?? {},
      hint: "Runs in which this oracle found a violation, or the outcome that is chosen",
    },
    // An outcome says something of an oracle only.
    ...(firstOf(search, "oracle") ? [OUTCOME] : []),
    {
      name: "at_fault",
      title: "At fault",
      values: ["true", "false"],
      words: { true: "an ego at fault", false: "no ego at fault" },
      single: true,
      counts: counts && { true: counts.at_fault, false: counts.not_at_fault },
    },
    {
      name: "accountability",
      title: "Avoidability",
      values: Object.keys(ACCOUNTABILITY_WORDS),
      words: ACCOUNTABILITY_WORDS,
      single: true,
      counts: counts?.accountability,
      hint: "The strongest accountability of a run's violations",
    },
    // Links lead to it: the hash of a scenario is not typed.
    ...(firstOf(search, "scenario_sha256")
      ? [sameScenario(firstOf(search, "scenario_sha256"))]
      : []),
    { name: "agent", title: "ADS", single: true, counts: counts?.agent ?? {} },
    configurationFilter(counts?.configurations ?? []),
    { name: "town", title: "Town", single: true, counts: counts?.town ?? {} },
    {
      name: "campaign",
      title: "Campaign",
      single: true,
      values: Object.keys(names.campaigns),
      words: names.campaigns,
    },
    {
      name: "batch",
      title: "Batch",
      single: true,
      values: Object.keys(names.batches),
      words: names.batches,
    },
    {
      name: "since",
      title: "Since",
      single: true,
      time: true,
      hint: "Queued at this time or later",
    },
    { name: "until", title: "Until", single: true, time: true, hint: "Queued before this time" },
  ];
}

function sameScenario(sha256: string): Filter {
  return {
    name: "scenario_sha256",
    title: "Scenario",
    single: true,
    values: [sha256],
    words: { [sha256]: sha256.slice(0, 8) },
    hint: "Runs of one scenario, by its hash",
  };
}

const OUTCOME: Filter = {
  name: "outcome",
  title: "Outcome",
  values: ["violated", "not_measurable"],
  single: true,
  hint: "What the oracle found: violated, unless said otherwise",
};

/** Names by id, for filters by what runs belong to. */
export interface Names {
  readonly campaigns: Readonly<Record<string, string>>;
  readonly batches: Readonly<Record<string, string>>;
}

/** Views that help to begin with. */
export const GIVEN_VIEWS: readonly { readonly name: string; readonly search: Search }[] = [
  { name: "All runs", search: {} },
  { name: "Avoidable, an ego at fault", search: { accountability: "avoidable" } },
  { name: "Failing", search: { failing: "true" } },
  { name: "Not at fault, but avoidable", search: { accountability: "preventable" } },
  { name: "Violations without fault of an ego", search: { at_fault: "false" } },
  { name: "Not judged", search: { status: NOT_JUDGED } },
  { name: "Waiting or running", search: { status: ["queued", "running"] } },
];
