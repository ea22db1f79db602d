import { useQuery } from "@tanstack/react-query";
import { useNavigate, useSearch } from "@tanstack/react-router";
import { valuesOf } from "../../address";
import { api, body } from "../../api/client";
import { type Filter, Filters } from "../../components/Filters";
import { count } from "../../components/numbers";
import { Empty, Loading, Refused } from "../../components/States";
import { useTitle } from "../../shell/useTitle";
import { AgentCard } from "./AgentCard";
import { AgentComparison } from "./AgentComparison";
import type { Agent } from "./agent";

/** Returns the filters of the list; their counts are of all agents. */
function filtersOf(agents: readonly Agent[]): readonly Filter[] {
  const counted = (of: (agent: Agent) => string) => {
    const counts: Record<string, number> = {};
    for (const agent of agents) counts[of(agent)] = (counts[of(agent)] ?? 0) + 1;
    return counts;
  };
  return [
    { name: "kind", title: "Kind", counts: counted(({ kind }) => kind) },
    {
      name: "usable",
      title: "Usable here",
      single: true,
      values: ["true", "false"],
      words: { true: "yes", false: "no" },
      counts: counted(({ installed }) => String(installed)),
    },
    {
      name: "privileged",
      title: "Perception",
      single: true,
      values: ["false", "true"],
      words: { false: "through the perception model", true: "privileged" },
      counts: counted(({ privileged }) => String(privileged)),
    },
  ];
}

/** The ADSs that can drive an ego. */
export function Agents() {
  useTitle("Agents");
  const navigate = useNavigate();
  const search = useSearch({ from: "/agents" });
  const query = useQuery({
    queryKey: ["agents"],
    queryFn: async () => body(await api.GET("/api/v1/agents")),
  });
  const counts = useQuery({
    queryKey: ["run", "list", "counts", {}],
    queryFn: async () => body(await api.GET("/api/v1/runs:counts")),
  });
  if (query.isPending) return <Loading />;
  if (query.isError) return <Refused error={query.error} onRepeat={() => void query.refetch()} />;
  const all = query.data.items;
  const passes = (name: string, value: string) => {
    const wanted = valuesOf(search, name);
    return wanted.length === 0 || wanted.includes(value);
  };
  const shown = all
    .filter(
      (agent) =>
        passes("kind", agent.kind) &&
        passes("usable", String(agent.installed)) &&
        passes("privileged", String(agent.privileged)),
    )
    .toSorted((a, b) => Number(b.installed) - Number(a.installed));
  const names = valuesOf(search, "compare");
  const chosen = names.flatMap((name) => all.find((agent) => agent.name === name) ?? []);
  const compare = (next: readonly string[]) =>
    void navigate({
      to: "/agents",
      search: { ...search, compare: next },
      replace: true,
      resetScroll: false,
    });
  const usable = all.filter(({ installed }) => installed).length;
  return (
    <>
      <div className="head">
        <h1>Agents</h1>
        <p className="answer" role="status">
          {count(usable)} of {count(all.length)} ADSs can be used here
          {chosen.length === 1 && " · choose another to compare"}
        </p>
      </div>
      <Filters filters={filtersOf(all)} search={search} />
      {chosen.length > 1 && <AgentComparison agents={chosen} onClose={() => compare([])} />}
      {shown.length === 0 ? (
        <Empty title="No ADS matches">
          <p>Remove a filter.</p>
        </Empty>
      ) : (
        <div className="agents">
          {shown.map((agent) => (
            <AgentCard
              key={agent.name}
              agent={agent}
              runs={counts.data?.agent[agent.name] ?? 0}
              selected={names.includes(agent.name)}
              onSelect={() =>
                compare(
                  names.includes(agent.name)
                    ? names.filter((name) => name !== agent.name)
                    : [...names, agent.name],
                )
              }
            />
          ))}
        </div>
      )}
    </>
  );
}
