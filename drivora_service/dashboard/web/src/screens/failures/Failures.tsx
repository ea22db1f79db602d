import { Link, useNavigate, useSearch } from "@tanstack/react-router";
import { useState } from "react";
import { firstOf, type Search } from "../../address";
import { api, body, type Schemas } from "../../api/client";
import { Filters } from "../../components/Filters";
import { askedBy } from "../../components/filterValues";
import { count } from "../../components/numbers";
import { Empty, Loading, Refused } from "../../components/States";
import { News } from "../../lists/News";
import { useLiveList } from "../../lists/useLiveList";
import { useTitle } from "../../shell/useTitle";
import { failureFilters } from "./filters";
import { GroupCards } from "./GroupCards";
import { GroupFailures } from "./GroupFailures";
import { useFailureNames } from "./useFailureNames";
import { groupText } from "./words";

type Group = Schemas["FailureGroup"];

const PAGE = 60;
const idOf = ({ group }: Group) => group;

/** Failures of all campaigns and batches: their groups, or the failures of one. */
export function Failures() {
  useTitle("Failures");
  const search = useSearch({ from: "/failures" });
  const names = useFailureNames();
  const filters = failureFilters(names.oracles, names.agents, names.towns);
  const group = firstOf(search, "group");
  return (
    <>
      <div className="head">
        <h1>Failures</h1>
        {group && (
          <p className="answer">
            <Link to="/failures" search={{ ...search, group: undefined, id: undefined }}>
              All groups
            </Link>{" "}
            › {groupText(group)}
          </p>
        )}
        <div className="actions">
          <Link to="/minimizations" search={{}} className="button">
            Minimisations
          </Link>
        </div>
      </div>
      <Filters filters={filters} search={search} />
      {group ? (
        <GroupFailures filters={{ ...askedBy(search, filters), group }} search={search} />
      ) : (
        <Groups filters={askedBy(search, filters)} search={search} />
      )}
    </>
  );
}

function Groups({
  filters,
  search,
}: {
  readonly filters: Readonly<Record<string, string | readonly string[]>>;
  readonly search: Search;
}) {
  const navigate = useNavigate();
  const [held, setHeld] = useState(false);
  const { query, rows, news, insertNews, more } = useLiveList<Group>({
    key: ["failure groups", filters],
    kind: "run",
    ask: async (page_token) =>
      body(
        await api.GET("/api/v1/failures/groups", {
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
      <Empty
        title={Object.keys(filters).length > 0 ? "No failure matches" : "No failure yet"}
        command={`drivora campaign run campaign.yaml --server ${window.location.origin}`}
      >
        <p>
          A campaign searches for failures.
          {Object.keys(filters).length > 0 && " Remove a filter to see those of other kinds."}
        </p>
      </Empty>
    );
  const sum = (of: (group: Group) => number) => rows.reduce((total, one) => total + of(one), 0);
  return (
    <>
      <p className="answer">
        {count(rows.length)}
        {query.hasNextPage ? " or more" : ""} groups, the last seen first:{" "}
        <Link to="." search={{ ...search, accountability: "avoidable" }}>
          {count(sum(({ avoidable }) => avoidable))} failures that count
        </Link>{" "}
        and {count(sum(({ others }) => others))} others.
      </p>
      <div className="with-news">
        <News news={news} onInsert={insertNews} />
        <GroupCards
          groups={rows}
          search={search}
          onOpen={(group) => void navigate({ to: ".", search: { ...search, group } })}
          onHold={setHeld}
        />
      </div>
      {query.hasNextPage && (
        <button type="button" onClick={more} style={{ alignSelf: "center" }}>
          More groups
        </button>
      )}
    </>
  );
}
