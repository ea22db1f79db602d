import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../../api/client";
import { readPages } from "../../../lists/readPages";
import { placesOf } from "./failurePlaces";

type Failure = Schemas["Failure"];

const PAGE = 500;
/** More marks than these hide each other. */
export const MOST_PLACES = 2000;

/** Reads the failures of a campaign for a map of their places. */
export function useFailurePlaces({ id, town, seeds, counts }: Schemas["Campaign"]) {
  return useQuery({
    // Read anew when there are more failures, not with each event.
    queryKey: ["failure places", id, counts.violating],
    placeholderData: keepPreviousData,
    queryFn: async () => {
      const { rows, more } = await readPages<Failure>(
        async (page) =>
          body(
            await api.GET("/api/v1/campaigns/{campaign_id}/failures", {
              params: { path: { campaign_id: id }, query: { limit: PAGE, ...page } },
            }),
          ),
        MOST_PLACES,
      );
      const several = new Set(seeds.map((seed) => seed.town)).size > 1;
      const seedOf = several ? await seedsOf(id) : undefined;
      const townOf = (evaluation: number) => seeds[seedOf?.get(evaluation) ?? -1]?.town ?? town;
      const places = placesOf(rows, townOf);
      return { places, missing: rows.length - places.length, more };
    },
  });
}

/** Reads the seed scenarios of the evaluations with failures: a failure does not name its own. */
async function seedsOf(id: string): Promise<ReadonlyMap<number, number>> {
  const { rows } = await readPages(
    async (page) =>
      body(
        await api.GET("/api/v1/campaigns/{campaign_id}/evaluations", {
          params: {
            path: { campaign_id: id },
            query: { violating: true, order: "number", limit: PAGE, ...page },
          },
        }),
      ),
    MOST_PLACES,
  );
  return new Map(rows.map(({ number, seed_number }) => [number, seed_number]));
}
