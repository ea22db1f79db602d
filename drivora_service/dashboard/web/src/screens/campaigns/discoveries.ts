import { useQuery } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../api/client";

export type Discoveries = Schemas["CampaignDiscoveries"];

/** Reads the failures of a campaign against simulations. */
export function useDiscoveries(id: string, points: number, kinds: number, enabled = true) {
  return useQuery({
    queryKey: ["campaign", id, "discoveries", points, kinds],
    enabled,
    queryFn: async () =>
      body(
        await api.GET("/api/v1/campaigns/{campaign_id}/discoveries", {
          params: { path: { campaign_id: id }, query: { points, kinds } },
        }),
      ),
  });
}
