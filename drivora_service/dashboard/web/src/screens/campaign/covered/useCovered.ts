import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../../api/client";
import { askedFor } from "./askedFor";

type Campaign = Schemas["Campaign"];

const AGAIN_MS = 1000;

/** Reads the figures of a campaign. */
export function useFigures(campaign: Campaign) {
  return useQuery({
    queryKey: ["figures", campaign.id, campaign.state, askedFor(campaign)],
    placeholderData: keepPreviousData,
    queryFn: async () =>
      body(
        await api.GET("/api/v1/campaigns/{campaign_id}/figures", {
          params: { path: { campaign_id: campaign.id } },
        }),
      ),
  });
}

/** Reads what a campaign covers, again and again until the service has counted all evaluations. */
export function useCoverage(campaign: Campaign) {
  return useQuery({
    queryKey: ["coverage", campaign.id, campaign.state, askedFor(campaign)],
    placeholderData: keepPreviousData,
    queryFn: async ({ client, queryKey }) => {
      const before = client.getQueryData<Schemas["CampaignCoverage"]>(queryKey);
      const now: Schemas["CampaignCoverage"] = body(
        await api.GET("/api/v1/campaigns/{campaign_id}/coverage", {
          params: { path: { campaign_id: campaign.id } },
        }),
      );
      // Evaluations that cannot be counted are not asked for without an end.
      const grows = now.counted > (before?.counted ?? -1);
      return { ...now, goesOn: now.counted < now.evaluations && grows };
    },
    refetchInterval: ({ state }) => (state.data?.goesOn ? AGAIN_MS : false),
  });
}
