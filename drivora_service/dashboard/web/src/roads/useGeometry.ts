import { useQuery } from "@tanstack/react-query";
import { api, body } from "../api/client";

export function useGeometry(name: string) {
  return useQuery({
    queryKey: ["network", name, "geometry"],
    queryFn: async () =>
      body(await api.GET("/api/v1/networks/{name}/geometry", { params: { path: { name } } })),
    enabled: name !== "",
    gcTime: 30 * 60_000,
  });
}
