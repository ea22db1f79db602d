import { useQueries, useQuery } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../api/client";
import { documentSchemas } from "../../components/fields/documentSchemas";
import type { Definitions, JsonSchema } from "../../components/fields/jsonSchema";
import type { JsonObject } from "../../components/fields/pointers";
import type { KnownRate } from "./estimate";

/** What a form offers. */
export interface Catalogues {
  readonly definitions: Definitions;
  readonly agents: readonly Schemas["Agent"][];
  readonly testers: readonly Schemas["Tester"][];
  readonly oracles: readonly Schemas["Oracle"][];
  readonly presets: readonly Schemas["SpacePresetInList"][];
}

/** Reads what a form offers; it does not change while the service runs. */
export function useCatalogues() {
  return useQueries({
    queries: [
      documentSchemas,
      { queryKey: ["agents"], queryFn: async () => body(await api.GET("/api/v1/agents")) },
      {
        queryKey: ["testers", "list"],
        queryFn: async () => body(await api.GET("/api/v1/testers")),
      },
      { queryKey: ["oracles"], queryFn: async () => body(await api.GET("/api/v1/oracles")) },
      {
        queryKey: ["space-presets"],
        queryFn: async () => body(await api.GET("/api/v1/campaigns:presets")),
      },
    ],
    combine: ([schemas, agents, testers, oracles, presets]) => {
      const all = [schemas, agents, testers, oracles, presets];
      const error = all.find((one) => one.isError)?.error;
      const again = () => {
        for (const one of all) if (one.isError) void one.refetch();
      };
      if (!schemas.data || !agents.data || !testers.data || !oracles.data || !presets.data)
        return { error, again, data: undefined };
      const data: Catalogues = {
        definitions: schemas.data,
        agents: agents.data.items,
        testers: testers.data.items,
        oracles: oracles.data.items,
        presets: presets.data.items,
      };
      return { error: undefined, again, data };
    },
  });
}

/** Returns the options of the named spaces by name. */
export function presetOptions(
  presets: readonly Schemas["SpacePresetInList"][],
): ReadonlyMap<string, JsonObject> {
  return new Map(presets.map(({ name, options }) => [name, options as JsonObject]));
}

/** Returns the parameters of an ADS or a tester as the properties of an object. */
export function parameterSchemas(
  parameters: readonly (Schemas["AgentParameter"] | Schemas["TesterParameter"])[],
): Readonly<Record<string, JsonSchema>> {
  return Object.fromEntries(
    parameters.map(({ name, default: standard, values, description }) => [
      name,
      { ...(values as JsonSchema), default: standard, description },
    ]),
  );
}

const RATES = { state: ["finished"] as Schemas["CampaignState"][], limit: 500 };

/** How fast the newest finished campaigns were. */
export function useKnownRates(): readonly KnownRate[] {
  const { data } = useQuery({
    queryKey: ["campaign", "list", "rates"],
    queryFn: async () =>
      body(await api.GET("/api/v1/campaigns", { params: { query: RATES } })).items,
  });
  return (data ?? []).flatMap(({ agent, town, rate }) =>
    rate === null ? [] : [{ agent, town, rate }],
  );
}
