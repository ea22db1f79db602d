import { useSearch } from "@tanstack/react-router";
import { valuesOf } from "../../address";
import { api, body, type Schemas } from "../../api/client";
import { type Column, DataTable } from "../../components/DataTable";
import { Filters } from "../../components/Filters";
import { Mark } from "../../components/Mark";
import { count, fixed, moment } from "../../components/numbers";
import { Empty, Loading, Refused } from "../../components/States";
import { useList } from "../../lists/useList";
import { useTitle } from "../../shell/useTitle";
import { lookOfRun, STATUSES } from "./status";

type Run = Schemas["RunSummary"];

const COLUMNS: readonly Column<Run>[] = [
  { id: "id", title: "Run", width: "200px", cell: (run) => <code>{run.id}</code> },
  { id: "status", title: "Status", width: "170px", cell: (run) => <Mark {...lookOfRun(run)} /> },
  { id: "label", title: "Label", width: "minmax(160px, 1fr)", cell: (run) => run.label },
  { id: "agent", title: "ADS", width: "130px", cell: (run) => run.agent },
  { id: "town", title: "Town", width: "110px", cell: (run) => run.town },
  {
    id: "violations",
    title: "Violations",
    width: "90px",
    numeric: true,
    cell: (run) => count(run.violations),
  },
  {
    id: "at_fault",
    title: "At fault",
    width: "80px",
    numeric: true,
    cell: (run) => count(run.at_fault_violations),
  },
  {
    id: "sim_time_s",
    title: "Simulated (s)",
    width: "100px",
    numeric: true,
    cell: (run) => fixed(run.sim_time_s, 1),
  },
  { id: "created_at", title: "Queued at", width: "160px", cell: (run) => moment(run.created_at) },
];

const FILTERS = [
  { name: "status", title: "Status", values: STATUSES },
  { name: "violated", title: "Oracle" },
  { name: "agent", title: "ADS" },
  { name: "town", title: "Town" },
  { name: "batch", title: "Batch" },
] as const;

export function Runs() {
  useTitle("Runs");
  const search = useSearch({ from: "/runs" });
  const filters = Object.fromEntries(
    FILTERS.map(({ name }) => [name, valuesOf(search, name)]).filter(([, found]) => found?.length),
  );
  const { query, rows, more } = useList<Run>(["run", "list", filters], async (page_token) =>
    body(
      await api.GET("/api/v1/runs", {
        params: { query: { limit: 100, ...filters, ...(page_token ? { page_token } : {}) } },
      }),
    ),
  );
  return (
    <>
      <div className="head">
        <h1>Runs</h1>
      </div>
      <Filters filters={FILTERS} search={search} />
      {query.isPending ? (
        <Loading />
      ) : query.isError ? (
        <Refused error={query.error} onRepeat={() => void query.refetch()} />
      ) : rows.length === 0 ? (
        <Empty title="No run matches" command="drivora run scenario.json --server URL">
          <p>Queue a scenario, or remove a filter.</p>
        </Empty>
      ) : (
        <DataTable label="Runs" columns={COLUMNS} rows={rows} idOf={(run) => run.id} onEnd={more} />
      )}
    </>
  );
}
