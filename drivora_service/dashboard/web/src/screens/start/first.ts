import type { QueryClient } from "@tanstack/react-query";
import { api, body } from "../../api/client";

/** Returns the screen to begin with: campaigns if there are any, else runs; `undefined` if nothing ran. */
export async function firstScreen(
  queries: QueryClient,
): Promise<"/campaigns" | "/runs" | undefined> {
  const query = { params: { query: { limit: 1 } } };
  const ask = <T>(name: string, queryFn: () => Promise<T>) =>
    queries.fetchQuery({ queryKey: ["start", name], queryFn, staleTime: 0 });
  const campaigns = await ask("campaigns", async () =>
    body(await api.GET("/api/v1/campaigns", query)),
  );
  if (campaigns.items.length > 0) return "/campaigns";
  const runs = await ask("runs", async () => body(await api.GET("/api/v1/runs", query)));
  return runs.items.length > 0 ? "/runs" : undefined;
}
