import { queryOptions, useQuery } from "@tanstack/react-query";
import { Link, useNavigate } from "@tanstack/react-router";
import type { ReactNode } from "react";
import type { Search } from "../../address";
import { api, body } from "../../api/client";
import { Copy } from "../../components/Copy";
import { Loading, Refused } from "../../components/States";
import { serviceAddress } from "../../service";
import { useKeys } from "../../shell/keys";
import { useTitle } from "../../shell/useTitle";
import { GroupDecision } from "./GroupDecision";
import { GroupFailures } from "./GroupFailures";
import { countWords, titleOf } from "./triage";

type Asked = Readonly<Record<string, string | readonly string[]>>;

const MOST_IN_LINE = 500;

function groupQuery(id: string) {
  return queryOptions({
    queryKey: ["group", id],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/failures/groups/{group_id}", {
          params: { path: { group_id: id } },
        }),
      ),
  });
}

/** A group: what was decided about it, and its failures. `n` and `p` go to the next ones. */
export function GroupScreen({
  id,
  filters,
  groupFilters,
  search,
  children,
}: {
  readonly id: string;
  /** The filters of its failures. */
  readonly filters: Asked;
  /** The filters of the groups among which it is. */
  readonly groupFilters: Asked;
  readonly search: Search;
  /** The menus of the filters. */
  readonly children: ReactNode;
}) {
  const navigate = useNavigate();
  const query = useQuery(groupQuery(id));
  // The line in which groups follow one another stays while the reader goes through it.
  const { data: line } = useQuery({
    queryKey: ["line of groups", groupFilters],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/failures/groups", {
          params: { query: { limit: MOST_IN_LINE, ...groupFilters } },
        }),
      ).items.map((group) => group.id),
    staleTime: Number.POSITIVE_INFINITY,
  });
  const place = line?.indexOf(id) ?? -1;
  // Read ahead, so that it is there at once.
  const following = line?.[place + 1] ?? "";
  useQuery({ ...groupQuery(following), enabled: following !== "" });
  const go = (by: number) => {
    const next = line?.[place + by];
    if (next !== undefined && (place >= 0 || by > 0))
      void navigate({ to: ".", search: { ...search, group: next, id: undefined } });
  };
  useKeys([
    { keys: "n", does: "next group", run: () => go(1) },
    { keys: "p", does: "previous group", run: () => go(-1) },
  ]);
  const title = query.data ? titleOf(query.data) : "Group of failures";
  useTitle(title);
  const listed = { ...search, group: undefined, id: undefined };
  return (
    <>
      <div className="head">
        <h1>{title}</h1>
        <p className="answer">
          <Link to="/failures" search={listed}>
            All groups
          </Link>{" "}
          › {query.data && countWords(query.data)}
          {line && place >= 0 && `, ${place + 1} of ${line.length}`}
        </p>
        <div className="actions">
          <button
            type="button"
            title="Previous group (p)"
            disabled={place < 1}
            onClick={() => go(-1)}
          >
            Previous
          </button>
          <button
            type="button"
            title="Next group (n)"
            disabled={!line || place + 1 >= line.length}
            onClick={() => go(1)}
          >
            Next
          </button>
          <Copy text={`${serviceAddress()}/failures?group=${id}`} label="Copy link" />
        </div>
      </div>
      {query.isPending && <Loading rows={4} />}
      {query.isError && <Refused error={query.error} onRepeat={() => void query.refetch()} />}
      {query.data && (
        <>
          <GroupDecision key={id} group={query.data} />
          {children}
          <GroupFailures group={query.data} filters={{ ...filters, group: id }} search={search} />
        </>
      )}
    </>
  );
}
