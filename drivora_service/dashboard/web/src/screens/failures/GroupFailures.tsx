import { useNavigate } from "@tanstack/react-router";
import { useState } from "react";
import { firstOf, type Search } from "../../address";
import { api, body, type Schemas } from "../../api/client";
import { Ads } from "../../components/Ads";
import { type Column, DataTable } from "../../components/DataTable";
import { Mark } from "../../components/Mark";
import { fixed, moment } from "../../components/numbers";
import { Empty, Loading, Refused } from "../../components/States";
import { News } from "../../lists/News";
import { useLiveList } from "../../lists/useLiveList";
import { useScope } from "../../shell/session";
import { FailureCard } from "./FailureCard";
import type { Group } from "./triage";
import { useDecisions } from "./useDecisions";
import { ACCOUNTABILITY } from "./words";

type Failure = Schemas["FoundFailure"];

const PAGE = 100;
const idOf = ({ id }: Failure) => String(id);

const COLUMNS: readonly Column<Failure>[] = [
  {
    id: "sentence",
    title: "What happened",
    width: "minmax(220px, 1fr)",
    cell: ({ sentence }) => <span title={sentence}>{sentence}</span>,
  },
  {
    id: "accountability",
    title: "Accountability",
    width: "164px",
    cell: ({ accountability }) =>
      accountability ? (
        <Mark {...ACCOUNTABILITY[accountability]} />
      ) : (
        <span className="quiet">not recorded</span>
      ),
  },
  { id: "agent", title: "ADS", width: "104px", cell: (one) => <Ads of={one} /> },
  { id: "town", title: "Town", width: "98px", cell: ({ town }) => town },
  {
    id: "time",
    title: "Time (s)",
    width: "74px",
    numeric: true,
    cell: ({ verdict }) => fixed(verdict.time, 2),
  },
  {
    id: "found",
    title: "Found at",
    width: "130px",
    cell: ({ found_at }) => <span title={moment(found_at)}>{moment(found_at).slice(0, 16)}</span>,
  },
];

/**
 * The failures of a group one after the other: `j` and `k` show each with its picture, `x` selects
 * those to split off.
 */
export function GroupFailures({
  group,
  filters,
  search,
}: {
  readonly group: Group;
  readonly filters: Readonly<Record<string, string | readonly string[]>>;
  readonly search: Search;
}) {
  const navigate = useNavigate();
  const { maySubmit } = useScope();
  const { split } = useDecisions();
  const [held, setHeld] = useState(false);
  const [selected, setSelected] = useState<ReadonlySet<string>>(new Set());
  const [label, setLabel] = useState("");
  const { query, rows, left, news, insertNews, more } = useLiveList<Failure>({
    key: ["failures", filters],
    kind: "run",
    ask: async (page_token) =>
      body(
        await api.GET("/api/v1/failures", {
          params: { query: { limit: PAGE, ...filters, ...(page_token ? { page_token } : {}) } },
        }),
      ),
    idOf,
    held,
    newestFirst: true,
  });
  if (query.isPending) return <Loading />;
  if (query.isError) return <Refused error={query.error} onRepeat={() => void query.refetch()} />;
  if (rows.length === 0)
    return (
      <Empty title="No failure of this group matches">
        <p>Remove a filter.</p>
      </Empty>
    );
  const chosen = rows.find((row) => idOf(row) === firstOf(search, "id"));
  const shown = chosen ?? rows[0];
  const choose = (row: Failure) =>
    void navigate({ to: ".", search: { ...search, id: idOf(row) }, replace: true });
  return (
    <div className="two wide-first">
      <div className="with-news">
        <News news={news} onInsert={insertNews} />
        {split.isError && (
          <p role="alert" className="refusal">
            {split.error.message}
          </p>
        )}
        {selected.size > 0 && (
          <form
            className="selected-groups"
            onSubmit={(event) => {
              event.preventDefault();
              const failures = [...selected].map(Number);
              split.mutate(
                { id: group.id, failures, names: [], label },
                { onSuccess: (made) => void navigate({ to: ".", search: { group: made.id } }) },
              );
            }}
          >
            <input
              value={label}
              maxLength={200}
              aria-label="Label of the new group"
              placeholder="label of the new group"
              onChange={(event) => setLabel(event.target.value)}
            />
            <button type="submit" className="primary" disabled={split.isPending}>
              Split off {selected.size} {selected.size === 1 ? "failure" : "failures"}
            </button>
            <button
              type="button"
              onClick={() => setSelected(new Set())}
              aria-label="Select no failure"
            >
              ×
            </button>
          </form>
        )}
        <DataTable
          label="Failures"
          columns={COLUMNS}
          rows={rows}
          idOf={idOf}
          left={left}
          {...(maySubmit ? { selected, onSelect: setSelected } : {})}
          onHold={setHeld}
          onCurrent={choose}
          onOpen={choose}
          onEnd={more}
        />
      </div>
      {shown && <FailureCard failure={shown} />}
    </div>
  );
}
