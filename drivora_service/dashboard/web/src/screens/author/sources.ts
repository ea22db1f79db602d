import { useQuery } from "@tanstack/react-query";
import { firstOf, type Search } from "../../address";
import { ofEvaluation, ofRun } from "../compose/beginning";
import type { FoundScenario } from "../compose/draft";

/** Where a scenario comes from that an address names. */
export interface Source {
  readonly run: string;
  readonly campaign: string;
  readonly evaluation: string;
}

export function sourceOf(search: Search): Source | undefined {
  const source = {
    run: firstOf(search, "run"),
    campaign: firstOf(search, "campaign"),
    evaluation: firstOf(search, "evaluation"),
  };
  const isNamed = source.run !== "" || (source.campaign !== "" && source.evaluation !== "");
  return isNamed ? source : undefined;
}

/** Asks for the scenario of a run, or of an evaluation of a campaign. */
export function useSource(source: Source | undefined) {
  return useQuery({
    queryKey: ["scenario", source],
    enabled: source !== undefined,
    queryFn: async (): Promise<FoundScenario> => {
      const { run = "", campaign = "", evaluation = "" } = source ?? {};
      return run ? await ofRun(run) : await ofEvaluation(campaign, evaluation);
    },
  });
}
