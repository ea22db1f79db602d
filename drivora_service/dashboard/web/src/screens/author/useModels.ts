import { useQuery } from "@tanstack/react-query";
import { useMemo } from "react";
import { api, body, type Schemas } from "../../api/client";
import type { Models } from "./shownActors";

export interface KnownModels {
  readonly list: readonly Schemas["Model"][];
  readonly sizes: Models;
}

/** Returns the models of actors; none until they are there. */
export function useModels(): KnownModels {
  const { data } = useQuery({
    queryKey: ["models"],
    queryFn: async () => body(await api.GET("/api/v1/models")).items,
  });
  return useMemo(() => {
    const list = data ?? [];
    return { list, sizes: new Map(list.map((model) => [`${model.kind} ${model.name}`, model])) };
  }, [data]);
}
