import { queryOptions } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../api/client";
import { readPages } from "../../lists/readPages";

type Summary = Schemas["RunSummary"];

/** Pages of the newest runs that are looked through for recorded ones: campaigns keep few. */
const MOST_PAGES = 8;

/** Recorded runs that are looked for: more than are offered, as a reader may look for one. */
const MOST_WANTED = 200;

interface Of {
  readonly town?: string;
  readonly scenario_sha256?: string;
}

/** How finished runs with a recording are asked for, the newest first. */
export function recordedRuns(of: Of) {
  return queryOptions({
    queryKey: ["run", "list", "recorded", of],
    queryFn: async () => {
      let pages = 0;
      const { rows } = await readPages<Summary>(async (pageToken) => {
        const query = { ...of, ...pageToken, status: ["finished" as const], limit: 200 };
        const page = body(await api.GET("/api/v1/runs", { params: { query } }));
        pages += 1;
        return {
          items: page.items.filter(({ trace_sha256 }) => trace_sha256 !== ""),
          next_page_token: pages < MOST_PAGES ? page.next_page_token : "",
        };
      }, MOST_WANTED);
      return rows;
    },
  });
}
