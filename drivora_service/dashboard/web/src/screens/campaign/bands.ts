import { useQuery } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../api/client";

/** The method that a search is measured against: it learns nothing from what it finds. */
const BASELINE = "random";

/** Reads the quartiles of Random in the study of a campaign, at its scenario and with its ADS. */
export function useBands({ study_id, cell }: Schemas["Campaign"], points: number) {
  return useQuery({
    queryKey: ["bands", study_id ?? "", BASELINE, cell?.scenario, cell?.agent, points],
    enabled: Boolean(study_id && cell && cell.method !== BASELINE),
    // A study without Random has no such band: the answer to that is 422, and no error here.
    retry: false,
    queryFn: async () =>
      body(
        await api.GET("/api/v1/studies/{study_id}/bands", {
          params: {
            path: { study_id: study_id ?? "" },
            query: {
              method: [BASELINE],
              scenario: [cell?.scenario ?? ""],
              agent: [cell?.agent ?? ""],
              points,
            },
          },
        }),
      ),
  });
}
