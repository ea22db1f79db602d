import { useQuery } from "@tanstack/react-query";
import { firstOf, type Search } from "../../address";
import { api, body } from "../../api/client";
import type { JsonObject } from "../../components/fields/pointers";

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
    queryFn: async (): Promise<JsonObject> => {
      if (source?.run) {
        const path = { run_id: source.run };
        const answer = await api.GET("/api/v1/runs/{run_id}/scenario", { params: { path } });
        return body(answer) as unknown as JsonObject;
      }
      const path = {
        campaign_id: source?.campaign ?? "",
        number: Number(source?.evaluation ?? 0),
      };
      const answer = await api.GET(
        "/api/v1/campaigns/{campaign_id}/evaluations/{number}/scenario",
        { params: { path } },
      );
      return body(answer) as unknown as JsonObject;
    },
  });
}
