import { useQuery } from "@tanstack/react-query";
import { api, body } from "../../api/client";
import type { Filter } from "../../components/filterValues";
import { runsByDriver } from "./suite";

const NEWEST = 500;

/** The filter by the ADS that drove a suite, with how many of its newest runs each has. */
export function useDrivers(suite: string): Filter {
  const { data } = useQuery({
    queryKey: ["suite", "list", suite, "drivers"],
    queryFn: async () =>
      body(await api.GET("/api/v1/suite-runs", { params: { query: { suite, limit: NEWEST } } }))
        .items,
  });
  return { name: "agent", title: "ADS", single: true, counts: runsByDriver(data ?? []) };
}
