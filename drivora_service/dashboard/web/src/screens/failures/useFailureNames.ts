import { useQuery } from "@tanstack/react-query";
import { api, body } from "../../api/client";

/** Names that filters of failures offer. */
export function useFailureNames() {
  const { data } = useQuery({
    queryKey: ["run", "list", "counts of violated"],
    queryFn: async () =>
      body(await api.GET("/api/v1/runs:counts", { params: { query: { violated: true } } })),
  });
  const names = (counts: Readonly<Record<string, number>> | undefined) =>
    Object.entries(counts ?? {}).flatMap(([name, number]) => (number > 0 ? [name] : []));
  return {
    oracles: names(data?.oracle),
    agents: names(data?.agent),
    configurations: data?.configurations ?? [],
    towns: names(data?.town),
  };
}
