import { useQuery } from "@tanstack/react-query";
import { api, body } from "../../api/client";

/** What happened when in a run: violations, lights, lines of logs. */
export function useTimeline(run: string) {
  return useQuery({
    queryKey: ["run", run, "timeline"],
    queryFn: async () =>
      body(await api.GET("/api/v1/runs/{run_id}/timeline", { params: { path: { run_id: run } } })),
    enabled: run !== "",
  });
}
