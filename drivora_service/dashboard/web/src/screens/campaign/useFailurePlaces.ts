import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../api/client";

type Failure = Schemas["Failure"];

const PAGE = 500;
/** More marks than these hide each other. */
export const MOST_PLACES = 2000;

/** Reads the failures of a campaign for a map of their places. */
export function useFailurePlaces({ id, counts }: Schemas["Campaign"]) {
  return useQuery({
    // Read anew when there are more failures, not with each event.
    queryKey: ["failure places", id, counts.violating],
    placeholderData: keepPreviousData,
    queryFn: async () => {
      const found: Failure[] = [];
      let page_token: string | undefined;
      do {
        const page: Schemas["Page_Failure_"] = body(
          await api.GET("/api/v1/campaigns/{campaign_id}/failures", {
            params: {
              path: { campaign_id: id },
              query: { limit: PAGE, ...(page_token ? { page_token } : {}) },
            },
          }),
        );
        found.push(...page.items);
        page_token = page.next_page_token;
      } while (page_token && found.length < MOST_PLACES);
      return { failures: found, more: Boolean(page_token) };
    },
  });
}
