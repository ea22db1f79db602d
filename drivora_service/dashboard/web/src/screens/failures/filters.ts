import { configurationFilter } from "../../components/configuration";
import { COUNTED_WORDS } from "../../components/definition";
import type { Filter } from "../../components/filterValues";
import { ACCOUNTABILITY_WORDS } from "../runs/filters";
import { SINCE, SINCES, STATUS, STATUSES } from "./triage";

/** The filters of failures, as the API has them. */
export function failureFilters(
  oracles: readonly string[],
  agents: readonly string[],
  configurations: Parameters<typeof configurationFilter>[0],
  towns: readonly string[],
): readonly Filter[] {
  return [
    {
      name: "accountability",
      title: "Avoidability",
      values: Object.keys(ACCOUNTABILITY_WORDS),
      words: ACCOUNTABILITY_WORDS,
      single: true,
    },
    {
      name: "counts",
      title: "Counts",
      values: Object.keys(COUNTED_WORDS),
      words: COUNTED_WORDS,
      single: true,
      hint: "In place of what the suite, campaign or request of a run defined as a failure",
    },
    { name: "oracle", title: "Oracle", values: oracles, single: true },
    {
      name: "at_fault",
      title: "At fault",
      values: ["true", "false"],
      words: { true: "an ego at fault", false: "no ego at fault" },
      single: true,
    },
    { name: "agent", title: "ADS", values: agents, single: true },
    ofConfiguration(configurations),
    { name: "town", title: "Town", values: towns, single: true },
    {
      name: "confirmation",
      title: "Second run",
      values: ["confirmed", "open", "flaky"],
      single: true,
      hint: "Whether an identical run of the campaign repeated it",
    },
    { name: "study", title: "Study", single: true },
    { name: "campaign", title: "Campaign", single: true },
    { name: "batch", title: "Batch", single: true },
    { name: "since", title: "Found since", time: true, single: true },
  ];
}

/** Without numbers: those of runs are not those of failures. */
function ofConfiguration(known: Parameters<typeof configurationFilter>[0]): Filter {
  const { counts, ...filter } = configurationFilter(known);
  return { ...filter, values: Object.keys(counts) };
}

/** The filters of groups, beside those of their failures. */
export const GROUP_FILTERS: readonly Filter[] = [
  {
    name: "status",
    title: "Status",
    values: STATUSES,
    words: Object.fromEntries(STATUSES.map((status) => [status, STATUS[status].text])),
  },
  { name: "assignee", title: "Assignee", single: true },
];

/** How groups stand to a baseline; only with one. */
export const SINCE_FILTER: Filter = {
  name: "since_baseline",
  title: "Since the baseline",
  values: SINCES,
  words: Object.fromEntries(SINCES.map((since) => [since, SINCE[since].text])),
  single: true,
};

/** The name of the baseline in the address and the API. */
export const BASELINE: Filter = { name: "baseline", title: "Baseline", single: true };
