import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../api/client";
import { readPages } from "../../lists/readPages";

type Row = Schemas["EvaluationSummary"];

const PAGE = 500;
/** More points than these are no better to look at, and slow to draw. */
export const MOST = 5000;
/** While a campaign runs, its points are read anew after so many more. */
const EVERY = 25;

/** Reads the judged evaluations of a campaign in the order of asking, the first ones of many. */
export function useObjectives({ id, counts, state }: Schemas["Campaign"]) {
  const { evaluations } = counts;
  const version = state === "running" ? Math.floor(evaluations / EVERY) : evaluations;
  return useQuery({
    // Not renewed by each event, but with the number of evaluations.
    queryKey: ["objectives", id, version],
    placeholderData: keepPreviousData,
    queryFn: () =>
      readPages<Row>(
        async (page) =>
          body(
            await api.GET("/api/v1/campaigns/{campaign_id}/evaluations", {
              params: {
                path: { campaign_id: id },
                query: { status: "judged", order: "number", limit: PAGE, ...page },
              },
            }),
          ),
        MOST,
      ),
  });
}
