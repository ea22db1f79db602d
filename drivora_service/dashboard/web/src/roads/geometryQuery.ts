import { queryOptions } from "@tanstack/react-query";
import { api, body } from "../api/client";

/** How the geometry of a network is asked for. */
export function geometryQuery(name: string) {
  return queryOptions({
    queryKey: ["network", name, "geometry"],
    queryFn: async () =>
      body(await api.GET("/api/v1/networks/{name}/geometry", { params: { path: { name } } })),
    enabled: name !== "",
    gcTime: 30 * 60_000,
  });
}
