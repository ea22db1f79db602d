import { useQuery } from "@tanstack/react-query";
import { api, body } from "../../api/client";
import { configurationFilter } from "../../components/configuration";
import type { Filter } from "../../components/filterValues";
import { configurationsOf, runsByDriver } from "./suite";

const NEWEST = 500;

/** The filters by the ADS that drove a suite, with how many of its newest runs each has. */
export function useDrivers(suite: string): readonly Filter[] {
  const { data } = useQuery({
    queryKey: ["suite", "list", suite, "drivers"],
    queryFn: async () =>
      body(await api.GET("/api/v1/suite-runs", { params: { query: { suite, limit: NEWEST } } }))
        .items,
  });
  return [
    { name: "agent", title: "ADS", single: true, counts: runsByDriver(data ?? []) },
    configurationFilter(configurationsOf(data ?? [])),
  ];
}
