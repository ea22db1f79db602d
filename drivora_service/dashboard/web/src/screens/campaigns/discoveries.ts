import { useQuery } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../api/client";

export type Discoveries = Schemas["CampaignDiscoveries"];

/** How the failures of a campaign against simulations are asked for. */
export function discoveriesQuery(id: string, points: number, kinds: number) {
  return {
    queryKey: ["campaign", id, "discoveries", points, kinds],
    queryFn: async (): Promise<Discoveries> =>
      body(
        await api.GET("/api/v1/campaigns/{campaign_id}/discoveries", {
          params: { path: { campaign_id: id }, query: { points, kinds } },
        }),
      ),
  };
}

export function useDiscoveries(id: string, points: number, kinds: number, enabled = true) {
  return useQuery({ ...discoveriesQuery(id, points, kinds), enabled });
}
