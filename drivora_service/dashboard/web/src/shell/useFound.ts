import { useQuery } from "@tanstack/react-query";
import { api, body, type Schemas } from "../api/client";
import { nameOf } from "../screens/minimizations/minimization";
import { type Found, isId } from "./found";

/** As many of each kind are found by their names. */
export const NEWEST = 500;
const newest = { params: { query: { limit: NEWEST } } } as const;

/** Everything that has a name and can be opened; it is asked for when the reader searches.
 *
 * Of runs these are the newest, and the one whose whole id was typed.
 */
export function useFound(wanted: boolean, text: string): readonly Found[] {
  const runs = useQuery({
    queryKey: ["run", "list", "search"],
    queryFn: async () => body(await api.GET("/api/v1/runs", newest)).items,
    enabled: wanted,
  });
  const id = text.trim();
  const run = useQuery({
    queryKey: ["run", id, "search"],
    queryFn: async () =>
      body(await api.GET("/api/v1/runs/{run_id}", { params: { path: { run_id: id } } })),
    enabled: wanted && isId(id),
    retry: false,
  });
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
  const studies = useQuery({
    queryKey: ["study", "list", "search"],
    queryFn: async () => body(await api.GET("/api/v1/studies", newest)).items,
    enabled: wanted,
  });
  const minimizations = useQuery({
    queryKey: ["minimization", "list", "search"],
    queryFn: async () => body(await api.GET("/api/v1/minimizations", newest)).items,
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
    ...(studies.data ?? []).map(
      ({ id, name, state }): Found => ({ kind: "study", id, name: name || id, note: state }),
    ),
    ...(minimizations.data ?? []).map(
      (one): Found => ({
        kind: "minimization",
        id: one.id,
        name: `${nameOf(one)}, minimised`,
        note: one.state,
      }),
    ),
    ...(run.data ? [runFound(run.data)] : []),
    ...(runs.data ?? []).filter((item) => item.id !== run.data?.id).map(runFound),
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

function runFound(
  run: Pick<Schemas["RunSummary"], "id" | "label" | "configuration" | "town">,
): Found {
  const note = `${run.configuration}, ${run.town}`;
  return { kind: "run", id: run.id, name: run.label || run.id, note };
}
