import { useQuery } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../api/client";

export type Evaluation = Schemas["Evaluation"];

/** How an evaluation is asked for. It does not change any more, so no event renews it. */
export function evaluationQuery(campaign: string, number: number) {
  return {
    queryKey: ["evaluation", campaign, number],
    queryFn: async (): Promise<Evaluation> =>
      body(
        await api.GET("/api/v1/campaigns/{campaign_id}/evaluations/{number}", {
          params: { path: { campaign_id: campaign, number } },
        }),
      ),
  };
}

export function useEvaluation(campaign: string, number: number) {
  return useQuery(evaluationQuery(campaign, number));
}
