import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { useNavigate, useSearch } from "@tanstack/react-router";
import { useEffect, useMemo, useState } from "react";
import { firstOf } from "../../address";
import { api, body } from "../../api/client";
import { DataTable } from "../../components/DataTable";
import { Filters } from "../../components/Filters";
import { askedBy } from "../../components/filterValues";
import { SelectedTwo } from "../../components/SelectedTwo";
import { Empty, Loading, Refused } from "../../components/States";
import { ColumnMenu } from "../../lists/ColumnMenu";
import { useColumns } from "../../lists/columns";
import { News } from "../../lists/News";
import { ResultTables } from "../../lists/ResultTables";
import { useLiveList } from "../../lists/useLiveList";
import { ViewMenu } from "../../lists/ViewMenu";
import { serviceAddress } from "../../service";
import { useTitle } from "../../shell/useTitle";
import { CsvButton } from "./CsvButton";
import { type Run, runColumns, USUAL_COLUMNS } from "./columns";
import { GIVEN_VIEWS, runFilters } from "./filters";
import { type Pointed, RunPreview } from "./RunPreview";
import { RunsAnswer } from "./RunsAnswer";
import { useRunNames } from "./useRunNames";

const PAGE = 200;
const MOST = 500;
const idOf = (run: Run) => run.id;

export function Runs() {
  useTitle("Runs");
  const navigate = useNavigate();
  const search = useSearch({ from: "/runs" });
  const [held, setHeld] = useState(false);
  const [selected, setSelected] = useState<ReadonlySet<string>>(new Set());
  const [pointed, setPointed] = useState<Pointed>();
  const names = useRunNames();
  const sha = firstOf(search, "scenario_sha256");
  const filters = {
    ...askedBy(search, runFilters(undefined, names, search)),
    ...(sha && { scenario_sha256: sha }),
  };
  const oldestFirst = firstOf(search, "order") === "created_at";
  const order = oldestFirst ? "created_at" : "-created_at";
  const counts = useQuery({
    queryKey: ["run", "list", "counts", filters],
    queryFn: async () => body(await api.GET("/api/v1/runs:counts", { params: { query: filters } })),
    placeholderData: keepPreviousData,
  });
  const ask = (limit: number) => async (page_token: string | undefined) =>
    body(
      await api.GET("/api/v1/runs", {
        params: { query: { limit, order, ...filters, ...(page_token ? { page_token } : {}) } },
      }),
    );
  const { query, rows, left, news, insertNews, more } = useLiveList<Run>({
    key: ["run", filters, order],
    kind: "run",
    ask: ask(PAGE),
    idOf,
    held,
    newestFirst: !oldestFirst,
  });
  const all = useMemo(
    () =>
      runColumns(
        oldestFirst,
        () =>
          void navigate({
            to: "/runs",
            search: (now) => ({ ...now, order: oldestFirst ? undefined : "created_at" }),
          }),
      ),
    [oldestFirst, navigate],
  );
  const columns = useColumns("runs", all, USUAL_COLUMNS);
  const compare = ([one, other, third]: readonly string[]) => {
    if (one && other && !third)
      void navigate({ to: "/runs/$runId", params: { runId: one }, search: { with: other } });
  };
  // biome-ignore lint/correctness/useExhaustiveDependencies: with other filters the rows are others
  useEffect(() => setPointed(undefined), [search]);
  const named =
    names.batches[firstOf(search, "batch")] ??
    names.campaigns[firstOf(search, "campaign")] ??
    "runs";
  const anyFilter = Object.keys(filters).length > 0;
  return (
    <>
      <div className="head">
        <h1>Runs</h1>
        {counts.data && <RunsAnswer counts={counts.data} search={search} />}
        <div className="actions">
          <SelectedTwo
            number={selected.size}
            what="runs"
            onCompare={() => compare([...selected])}
            onClear={() => setSelected(new Set())}
          />
          <CsvButton name={named} ask={ask(MOST)} total={counts.data?.total} />
          <ResultTables name={named} conditions={filters} />
          <ViewMenu list="runs" given={GIVEN_VIEWS} search={search} />
          <ColumnMenu all={all} ids={columns.ids} toggle={columns.toggle} reset={columns.reset} />
        </div>
      </div>
      <Filters filters={runFilters(counts.data, names, search)} search={search} />
      {query.isPending ? (
        <Loading />
      ) : query.isError ? (
        <Refused error={query.error} onRepeat={() => void query.refetch()} />
      ) : rows.length === 0 ? (
        anyFilter ? (
          <Empty title="No run matches">
            <p>Remove a filter, or choose another view.</p>
          </Empty>
        ) : (
          <Empty
            title="No run yet"
            command={`drivora run scenario.json --server ${serviceAddress()}`}
          >
            <p>Each scenario that is queued is a run: it is simulated, judged and measured.</p>
          </Empty>
        )
      ) : (
        <div className="with-news">
          <News news={news} onInsert={insertNews} />
          <DataTable
            label="Runs"
            columns={columns.shown}
            rows={rows}
            idOf={idOf}
            left={left}
            onHold={setHeld}
            selected={selected}
            onSelect={setSelected}
            onCompare={compare}
            onPoint={(run, element) => setPointed(run && element ? { run, element } : undefined)}
            onEnd={more}
            onOpen={({ id }) => void navigate({ to: "/runs/$runId", params: { runId: id } })}
            height="calc(100vh - 196px)"
          />
          <RunPreview
            pointed={rows.some(({ id }) => id === pointed?.run.id) ? pointed : undefined}
          />
        </div>
      )}
    </>
  );
}
