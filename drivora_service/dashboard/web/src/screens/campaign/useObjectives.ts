import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../api/client";

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
    queryFn: async () => {
      const found: Row[] = [];
      let page_token: string | undefined;
      do {
        const page: Schemas["Page_EvaluationSummary_"] = body(
          await api.GET("/api/v1/campaigns/{campaign_id}/evaluations", {
            params: {
              path: { campaign_id: id },
              query: {
                status: "judged",
                order: "number",
                limit: PAGE,
                ...(page_token ? { page_token } : {}),
              },
            },
          }),
        );
        found.push(...page.items);
        page_token = page.next_page_token;
      } while (page_token && found.length < MOST);
      return { rows: found, more: Boolean(page_token) };
    },
  });
}
