import { useQuery } from "@tanstack/react-query";
import { api, body } from "../api/client";
import type { Found } from "./found";

const NEWEST = 500;
const newest = { params: { query: { limit: NEWEST } } } as const;

/** Everything that has a name and can be opened; it is asked for when the reader searches. */
export function useFound(wanted: boolean): readonly Found[] {
  const batches = useQuery({
    queryKey: ["batch", "list", "search"],
    queryFn: async () => body(await api.GET("/api/v1/batches", newest)).items,
    enabled: wanted,
  });
  const campaigns = useQuery({
    queryKey: ["campaign", "list", "search"],
    queryFn: async () => body(await api.GET("/api/v1/campaigns", newest)).items,
    enabled: wanted,
  });
  const networks = useQuery({
    queryKey: ["networks", "search"],
    queryFn: async () => body(await api.GET("/api/v1/networks")).items,
    enabled: wanted,
  });
  const agents = useQuery({
    queryKey: ["agents"],
    queryFn: async () => body(await api.GET("/api/v1/agents")),
    enabled: wanted,
  });
  return [
    ...(agents.data?.items ?? []).map(
      ({ name, kind }): Found => ({ kind: "agent", id: name, name, note: kind }),
    ),
    ...(networks.data ?? []).map(
      ({ name }): Found => ({ kind: "network", id: name, name, note: "" }),
    ),
    ...(campaigns.data ?? []).map(
      ({ id, name, state }): Found => ({ kind: "campaign", id, name: name || id, note: state }),
    ),
    ...(batches.data ?? []).map(
      ({ id, name, size }): Found => ({
        kind: "batch",
        id,
        name: name || id,
        note: `${size} runs`,
      }),
    ),
  ];
}
