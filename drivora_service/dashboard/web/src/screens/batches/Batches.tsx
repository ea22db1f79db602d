import { useQuery } from "@tanstack/react-query";
import { Link, useNavigate, useSearch } from "@tanstack/react-router";
import { useState } from "react";
import { valuesOf } from "../../address";
import { api, body } from "../../api/client";
import { type Column, DataTable } from "../../components/DataTable";
import { Filters } from "../../components/Filters";
import { Mark } from "../../components/Mark";
import { count, moment } from "../../components/numbers";
import { SelectedTwo } from "../../components/SelectedTwo";
import { Shares } from "../../components/Shares";
import { Empty, Loading, Refused } from "../../components/States";
import { News } from "../../lists/News";
import { useLiveList } from "../../lists/useLiveList";
import { serviceAddress } from "../../service";
import { useTitle } from "../../shell/useTitle";
import { NOT_JUDGED } from "../runs/status";
import { BatchActions } from "./BatchActions";
import {
  type Batch,
  isPriority,
  lookOfBatch,
  olderFirst,
  PRIORITIES,
  sharesOf,
  standingOf,
} from "./batch";

const PAGE = 100;
const FILTERS = [{ name: "priority", title: "Priority", values: PRIORITIES }] as const;
const idOf = (batch: Batch) => batch.id;

const COLUMNS: readonly Column<Batch>[] = [
  {
    id: "name",
    title: "Batch",
    width: "minmax(150px, 2fr)",
    cell: (batch) => (
      <Link to="/batches/$batchId" params={{ batchId: batch.id }}>
        {batch.name || <code>{batch.id}</code>}
      </Link>
    ),
  },
  {
    id: "state",
    title: "State",
    width: "100px",
    cell: (batch) => <Mark {...lookOfBatch(batch)} />,
  },
  { id: "priority", title: "Priority", width: "90px", cell: (batch) => batch.priority },
  {
    id: "progress",
    title: "Progress",
    width: "minmax(110px, 1fr)",
    cell: (batch) => <Shares shares={sharesOf(batch)} of={batch.size} />,
  },
  {
    id: "ended",
    title: "Ended",
    width: "80px",
    numeric: true,
    cell: (batch) => count(standingOf(batch).ended),
  },
  { id: "size", title: "Runs", width: "80px", numeric: true, cell: (batch) => count(batch.size) },
  {
    id: "violated",
    title: "With violations",
    width: "110px",
    numeric: true,
    cell: (batch) =>
      batch.violated_runs > 0 ? (
        <Link to="/runs" search={{ batch: batch.id, violated: "true" }}>
          {count(batch.violated_runs)}
        </Link>
      ) : (
        "0"
      ),
  },
  {
    id: "not_judged",
    title: "Not judged",
    hint: "Ended without a judgement, or cancelled",
    width: "90px",
    numeric: true,
    cell: (batch) => {
      const { notJudged, cancelled } = standingOf(batch);
      return notJudged + cancelled > 0 ? (
        <Link to="/runs" search={{ batch: batch.id, status: [...NOT_JUDGED, "cancelled"] }}>
          {count(notJudged + cancelled)}
        </Link>
      ) : (
        "0"
      );
    },
  },
  {
    id: "actions",
    title: "",
    width: "160px",
    cell: (batch) => (
      <span className="row-actions">
        <BatchActions batch={batch} />
      </span>
    ),
  },
  {
    id: "created_at",
    title: "Queued at",
    width: "162px",
    cell: (batch) => moment(batch.created_at),
  },
];

/** The batches that were submitted, newest first; those of campaigns can be left out. */
export function Batches() {
  useTitle("Batches");
  const search = useSearch({ from: "/batches" });
  const navigate = useNavigate();
  const priority = valuesOf(search, "priority").filter(isPriority);
  const filters = priority.length > 0 ? { priority } : {};
  const [held, setHeld] = useState(false);
  const [selected, setSelected] = useState<ReadonlySet<string>>(new Set());
  const { query, rows, left, news, insertNews, more } = useLiveList<Batch>({
    key: ["batch", "list", filters],
    kind: "batch",
    ask: async (page_token) =>
      body(
        await api.GET("/api/v1/batches", {
          params: { query: { limit: PAGE, ...filters, ...(page_token ? { page_token } : {}) } },
        }),
      ),
    idOf,
    held,
    newestFirst: true,
  });
  const compare = (ids: readonly string[]) => {
    const chosen = rows.filter(({ id }) => ids.includes(id));
    const [a, b, third] = chosen.toSorted(olderFirst);
    if (a && b && !third) void navigate({ to: "/compare/batches", search: { a: a.id, b: b.id } });
  };
  return (
    <>
      <div className="head">
        <h1>Batches</h1>
        <Answer />
        <div className="actions">
          <SelectedTwo
            number={selected.size}
            what="batches"
            onCompare={() => compare([...selected])}
            onClear={() => setSelected(new Set())}
          />
        </div>
      </div>
      <Filters filters={FILTERS} search={search} />
      {query.isPending ? (
        <Loading />
      ) : query.isError ? (
        <Refused error={query.error} onRepeat={() => void query.refetch()} />
      ) : rows.length === 0 ? (
        <Empty
          title={priority.length > 0 ? "No batch matches" : "No batch yet"}
          command={`drivora run scenarios/ --server ${serviceAddress()}`}
        >
          <p>Scenarios that are submitted together are a batch.</p>
        </Empty>
      ) : (
        <div className="with-news">
          <News news={news} onInsert={insertNews} />
          <DataTable
            label="Batches"
            columns={COLUMNS}
            rows={rows}
            idOf={idOf}
            left={left}
            onHold={setHeld}
            selected={selected}
            onSelect={setSelected}
            onCompare={compare}
            onEnd={more}
            onOpen={({ id }) => void navigate({ to: "/batches/$batchId", params: { batchId: id } })}
            height="calc(100vh - 170px)"
          />
        </div>
      )}
    </>
  );
}

/** How many runs wait, whatever batch they are of. */
function Answer() {
  const counts = useQuery({
    queryKey: ["run", "list", "counts", {}],
    queryFn: async () => body(await api.GET("/api/v1/runs:counts")),
  });
  if (!counts.data) return null;
  const { queued = 0, running = 0 } = counts.data.status;
  return (
    <p className="answer" role="status">
      {queued + running === 0 ? (
        "No run waits."
      ) : (
        <Link to="/runs" search={{ status: ["queued", "running"] }}>
          {count(running)} running, {count(queued)} waiting
        </Link>
      )}
    </p>
  );
}
