import { Link, useNavigate, useSearch } from "@tanstack/react-router";
import { useState } from "react";
import { api, body } from "../../api/client";
import { type Column, DataTable } from "../../components/DataTable";
import { Filters } from "../../components/Filters";
import { askedBy } from "../../components/filterValues";
import { Mark } from "../../components/Mark";
import { count, moment } from "../../components/numbers";
import { Progress } from "../../components/Progress";
import { Empty, Loading, Refused } from "../../components/States";
import { News } from "../../lists/News";
import { useLiveList } from "../../lists/useLiveList";
import { serviceAddress } from "../../service";
import { useTitle } from "../../shell/useTitle";
import { ACCOUNTABILITY } from "../failures/words";
import { oracleName } from "../replay/verdictWords";
import { lookOfMinimization, type Summary } from "./minimization";

const PAGE = 100;
const FILTERS = [{ name: "run", title: "Run", single: true }] as const;
const idOf = ({ id }: Summary) => id;

const COLUMNS: readonly Column<Summary>[] = [
  {
    id: "failure",
    title: "Failure",
    width: "minmax(160px, 1fr)",
    cell: ({ id, failure }) => (
      <Link to="/minimizations/$id" params={{ id }} search={{}}>
        {oracleName(failure.oracle)} of {failure.ego}
      </Link>
    ),
  },
  {
    id: "accountability",
    title: "Accountability",
    width: "220px",
    cell: ({ failure }) => <Mark {...ACCOUNTABILITY[failure.accountability]} />,
  },
  {
    id: "state",
    title: "State",
    width: "180px",
    cell: (one) => (
      <span title={one.message || undefined}>
        <Mark {...lookOfMinimization(one)} />
      </span>
    ),
  },
  {
    id: "actors",
    title: "Actors",
    width: "90px",
    numeric: true,
    cell: (one) => left(one, "actors"),
  },
  {
    id: "waypoints",
    title: "Waypoints",
    width: "100px",
    numeric: true,
    cell: (one) => left(one, "waypoints"),
  },
  {
    id: "decided",
    title: "Decided of budget",
    hint: "Simulations that the search needed so far, which the budget limits",
    width: "150px",
    cell: ({ decided, budget }) => <Progress done={decided} of={budget} />,
  },
  {
    id: "run",
    title: "Run",
    width: "minmax(240px, 1fr)",
    cell: ({ run_id }) => (
      <Link className="ink" to="/runs/$runId" params={{ runId: run_id }} search={{}}>
        <code>{run_id}</code>
      </Link>
    ),
  },
  {
    id: "created_at",
    title: "Queued at",
    width: "162px",
    cell: ({ created_at }) => moment(created_at),
  },
];

/** How much is left of a size, from what it was. */
function left({ before, after }: Summary, of: "actors" | "waypoints") {
  if (!before || !after) return "";
  return `${count(before[of])} → ${count(after[of])}`;
}

/** The minimisations that were asked for, newest first. */
export function Minimizations() {
  useTitle("Minimisations");
  const navigate = useNavigate();
  const search = useSearch({ from: "/minimizations" });
  const filters = askedBy(search, FILTERS);
  const [held, setHeld] = useState(false);
  const { query, rows, left, news, insertNews, more } = useLiveList<Summary>({
    key: ["minimization", filters],
    kind: "minimization",
    ask: async (page_token) =>
      body(
        await api.GET("/api/v1/minimizations", {
          params: { query: { limit: PAGE, ...filters, ...(page_token ? { page_token } : {}) } },
        }),
      ),
    idOf,
    held,
    newestFirst: true,
  });
  return (
    <>
      <div className="head">
        <h1>Minimisations</h1>
        <span className="answer">
          The smallest scenario that fails in the same way as a run, for each run that was
          minimised.
        </span>
      </div>
      <Filters filters={FILTERS} search={search} />
      {query.isPending ? (
        <Loading />
      ) : query.isError ? (
        <Refused error={query.error} onRepeat={() => void query.refetch()} />
      ) : rows.length === 0 ? (
        <Empty
          title={filters.run ? "This run was not minimised" : "No minimisation yet"}
          command={`drivora minimize ${filters.run ?? "RUN"} --server ${serviceAddress()}`}
        >
          <p>
            <em>Minimise</em> at the replay of a run with an ego at fault begins one, and so does
            the command.
          </p>
        </Empty>
      ) : (
        <div className="with-news">
          <News news={news} onInsert={insertNews} />
          <DataTable
            label="Minimisations"
            columns={COLUMNS}
            rows={rows}
            idOf={idOf}
            left={left}
            onHold={setHeld}
            onEnd={more}
            onOpen={({ id }) =>
              void navigate({ to: "/minimizations/$id", params: { id }, search: {} })
            }
            height="calc(100vh - 170px)"
          />
        </div>
      )}
    </>
  );
}
