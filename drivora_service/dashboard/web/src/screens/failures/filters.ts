import type { Filter } from "../../components/filterValues";
import { ACCOUNTABILITY_WORDS } from "../runs/filters";

/** The filters of failures, as the API has them. */
export function failureFilters(
  oracles: readonly string[],
  agents: readonly string[],
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
    { name: "oracle", title: "Oracle", values: oracles, single: true },
    {
      name: "at_fault",
      title: "At fault",
      values: ["true", "false"],
      words: { true: "an ego at fault", false: "no ego at fault" },
      single: true,
    },
    { name: "agent", title: "ADS", values: agents, single: true },
    { name: "town", title: "Town", values: towns, single: true },
    {
      name: "confirmation",
      title: "Second run",
      values: ["confirmed", "open", "flaky"],
      single: true,
      hint: "Whether an identical run of the campaign repeated it",
    },
    { name: "campaign", title: "Campaign", single: true },
    { name: "batch", title: "Batch", single: true },
    { name: "since", title: "Found since", time: true, single: true },
  ];
}
