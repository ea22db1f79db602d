import { useQuery } from "@tanstack/react-query";
import { api, body } from "../../api/client";
import type { Names } from "./filters";

const NAMED = 100;

/** The newest batches and campaigns by name, to filter by. */
export function useRunNames(): Names {
  const batches = useQuery({
    queryKey: ["batch", "list", "names"],
    queryFn: async () =>
      body(await api.GET("/api/v1/batches", { params: { query: { limit: NAMED } } })),
  });
  const campaigns = useQuery({
    queryKey: ["campaign", "list", "names"],
    queryFn: async () =>
      body(await api.GET("/api/v1/campaigns", { params: { query: { limit: NAMED } } })),
  });
  const named = (items: readonly { id: string; name: string }[] | undefined) =>
    Object.fromEntries((items ?? []).map(({ id, name }) => [id, name || id]));
  return { batches: named(batches.data?.items), campaigns: named(campaigns.data?.items) };
}
