import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../api/client";

const PAGE = 500;

/** Reads all campaigns of a study. */
export function useStudyCampaigns(id: string) {
  return useQuery({
    queryKey: ["study", id, "campaigns"],
    queryFn: async () => {
      const found: Schemas["CampaignSummary"][] = [];
      let page_token: string | undefined;
      do {
        const page: Schemas["Page_CampaignSummary_"] = body(
          await api.GET("/api/v1/campaigns", {
            params: { query: { study: id, limit: PAGE, ...(page_token ? { page_token } : {}) } },
          }),
        );
        found.push(...page.items);
        page_token = page.next_page_token;
      } while (page_token);
      // The newest comes first; the study's own order is that of their places.
      return found.reverse();
    },
  });
}

/** Reads the comparison of a study by one measure. */
export function useComparison(
  id: string,
  measure: string,
  baselines: { readonly baseline_method?: string; readonly baseline_agent?: string },
  enabled: boolean,
) {
  return useQuery({
    queryKey: ["study", id, "comparison", measure, baselines],
    enabled,
    placeholderData: keepPreviousData,
    queryFn: async () =>
      body(
        await api.GET("/api/v1/studies/{study_id}/comparison", {
          params: { path: { study_id: id }, query: { measure: [measure], ...baselines } },
        }),
      ),
  });
}

const POINTS = 200;

/** Reads the curves of all methods of a study. */
export function useStudyBands(id: string, enabled: boolean) {
  return useQuery({
    queryKey: ["study", id, "bands", "all", POINTS],
    enabled,
    queryFn: async () =>
      body(
        await api.GET("/api/v1/studies/{study_id}/bands", {
          params: { path: { study_id: id }, query: { points: POINTS } },
        }),
      ),
  });
}
