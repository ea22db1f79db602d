import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { api, body } from "../../api/client";
import { readPages } from "../../lists/readPages";
import { MEASURES } from "./measures";

const PAGE = 500;

/** Reads all campaigns of a study. */
export function useStudyCampaigns(id: string) {
  return useQuery({
    queryKey: ["study", id, "campaigns"],
    queryFn: async () => {
      const { rows } = await readPages(async (page) =>
        body(
          await api.GET("/api/v1/campaigns", {
            params: { query: { study: id, limit: PAGE, ...page } },
          }),
        ),
      );
      // The newest comes first; the study's own order is that of their places.
      return rows.toReversed();
    },
  });
}

/**
 * Reads the comparison of a study by all measures at once.
 *
 * It takes seconds, so that it is asked for anew when a campaign has finished, not with every run.
 */
export function useComparison(
  id: string,
  baselines: { readonly baseline_method?: string; readonly baseline_agent?: string },
  finished: number,
  enabled: boolean,
) {
  return useQuery({
    queryKey: ["comparison", id, baselines, finished],
    enabled,
    placeholderData: keepPreviousData,
    queryFn: async () =>
      body(
        await api.GET("/api/v1/studies/{study_id}/comparison", {
          params: {
            path: { study_id: id },
            query: { measure: MEASURES.map(({ name }) => name), ...baselines },
          },
        }),
      ),
  });
}

const POINTS = 200;

/** Reads the curves of the finished campaigns of a study by method. */
export function useStudyBands(id: string, finished: number) {
  return useQuery({
    queryKey: ["bands", id, finished],
    enabled: finished > 0,
    placeholderData: keepPreviousData,
    queryFn: async () =>
      body(
        await api.GET("/api/v1/studies/{study_id}/bands", {
          params: { path: { study_id: id }, query: { points: POINTS } },
        }),
      ),
  });
}
