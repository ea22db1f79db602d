import { type QueryClient, queryOptions } from "@tanstack/react-query";
import { api, body } from "../../api/client";
import { geometryQuery } from "../../roads/geometryQuery";

/** How a run is asked for. */
export function runQuery(id: string) {
  return queryOptions({
    queryKey: ["run", id],
    queryFn: async () =>
      body(await api.GET("/api/v1/runs/{run_id}", { params: { path: { run_id: id } } })),
    enabled: id !== "",
  });
}

/** Asks for a run and its network while the code of the replay is still being loaded. */
export async function prepareRun(queries: QueryClient, id: string): Promise<void> {
  try {
    const run = await queries.ensureQueryData(runQuery(id));
    if (run.trace_sha256) await queries.prefetchQuery(geometryQuery(run.town));
  } catch {
    // The screen asks again and shows what the service says.
  }
}
