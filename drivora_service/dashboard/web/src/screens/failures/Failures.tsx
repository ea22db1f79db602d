import { useQuery } from "@tanstack/react-query";
import { Link, useNavigate, useSearch } from "@tanstack/react-router";
import { useState } from "react";
import { firstOf, type Search } from "../../address";
import { api, body, type Schemas } from "../../api/client";
import { definitionSentence } from "../../components/definition";
import { Filters } from "../../components/Filters";
import { askedBy } from "../../components/filterValues";
import { count } from "../../components/numbers";
import { Empty, Loading, Refused } from "../../components/States";
import { News } from "../../lists/News";
import { useLiveList } from "../../lists/useLiveList";
import { serviceAddress } from "../../service";
import { useTitle } from "../../shell/useTitle";
import { BaselineMenu } from "./BaselineMenu";
import { BASELINE, failureFilters, GROUP_FILTERS, SINCE_FILTER } from "./filters";
import { GroupCards } from "./GroupCards";
import { GroupScreen } from "./GroupScreen";
import { type Group, SINCES, type Since } from "./triage";
import { useFailureNames } from "./useFailureNames";

type Asked = Readonly<Record<string, string | readonly string[]>>;

const PAGE = 60;
const MOST_COUNTED = 500;
const idOf = ({ id }: Group) => id;

/** Failures of all campaigns and batches: their groups, or one of these. */
export function Failures() {
  useTitle("Failures");
  const search = useSearch({ from: "/failures" });
  const navigate = useNavigate();
  const names = useFailureNames();
  const ofFailures = failureFilters(names.oracles, names.agents, names.configurations, names.towns);
  const group = firstOf(search, "group");
  const baseline = firstOf(search, "baseline");
  const ofGroups = [...GROUP_FILTERS, BASELINE, ...(baseline ? [SINCE_FILTER] : [])];
  const asked = askedBy(search, [...ofGroups, ...ofFailures]);
  if (group)
    return (
      <GroupScreen
        id={group}
        filters={askedBy(search, ofFailures)}
        groupFilters={asked}
        search={search}
      >
        <Filters filters={ofFailures} search={search} />
      </GroupScreen>
    );
  return (
    <>
      <div className="head">
        <h1>Failures</h1>
        <div className="actions">
          <BaselineMenu
            baseline={baseline}
            onChoose={(value) =>
              void navigate({
                to: ".",
                search: { ...search, baseline: value || undefined, since_baseline: undefined },
                replace: true,
              })
            }
          />
          <Link to="/minimizations" search={{}} className="button">
            Minimisations
          </Link>
        </div>
      </div>
      <Filters
        filters={[...ofGroups.filter((one) => one !== BASELINE), ...ofFailures]}
        search={search}
      />
      <Groups filters={asked} search={search} hasBaseline={baseline !== ""} />
    </>
  );
}

function Groups({
  filters,
  search,
  hasBaseline,
}: {
  readonly filters: Asked;
  readonly search: Search;
  readonly hasBaseline: boolean;
}) {
  const navigate = useNavigate();
  const [held, setHeld] = useState(false);
  const { query, rows, news, insertNews, more } = useLiveList<Group>({
    key: ["failure groups", filters],
    kind: "group",
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
        command={`drivora campaign run campaign.yaml --server ${serviceAddress()}`}
      >
        <p>
          A campaign searches for failures.
          {Object.keys(filters).length > 0 && " Remove a filter to see those of other kinds."}
        </p>
      </Empty>
    );
  const all = !query.hasNextPage;
  return (
    <>
      {hasBaseline ? (
        <SinceAnswer filters={filters} search={search} />
      ) : (
        <CountAnswer groups={rows} all={all} filters={filters} search={search} />
      )}
      <div className="with-news">
        <News news={news} onInsert={insertNews} />
        <GroupCards
          groups={rows}
          search={search}
          onOpen={(id) => void navigate({ to: ".", search: { ...search, group: id } })}
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

interface AnswerProps {
  readonly groups: readonly Group[];
  /** Whether there are no more than these. */
  readonly all: boolean;
  readonly filters: Asked;
  readonly search: Search;
}

/** How many failures there are, in how many runs, and what they count. */
function CountAnswer({ groups, all, filters, search }: AnswerProps) {
  const { status: _, assignee: __, ...query } = filters;
  const { data } = useQuery({
    queryKey: ["group", "counts", query],
    queryFn: async () =>
      body(await api.GET("/api/v1/failures:counts", { params: { query: { ...query } } })),
  });
  if (!data) return null;
  const { failures, avoidable, preventable, runs, definition } = data;
  const failed = data.agent_failed_runs ?? 0;
  return (
    <p className="answer">
      {count(failures)} failures
      {runs !== null && ` in ${count(runs)} ${runs === 1 ? "run" : "runs"}`}, {count(groups.length)}
      {all ? "" : " or more"} groups:{" "}
      <Link to="." search={{ ...search, accountability: "avoidable" }}>
        {count(avoidable)} at fault and avoidable
      </Link>
      ,{" "}
      <Link to="." search={{ ...search, accountability: "preventable" }}>
        {count(preventable)} not at fault, but avoidable
      </Link>
      {failed > 0 && (
        <>
          ; besides,{" "}
          <Link
            to="/runs"
            search={{ status: "agent_failed", ...(query.batch && { batch: query.batch }) }}
          >
            the ADS itself failed in {count(failed)} {failed === 1 ? "run" : "runs"}
          </Link>
        </>
      )}
      . <span className="quiet">{definitionOf(definition)}</span>
    </p>
  );
}

function definitionOf(definition: Schemas["FoundCounts"]["definition"]): string {
  return definition
    ? definitionSentence(definition)
    : "Each suite, campaign or request defines what its failures are; Counts switches that.";
}

const SINCE_WORDS: Readonly<Record<Since, string>> = {
  new: "new",
  same: "the same",
  gone: "gone",
};

/** How many groups are new, the same and gone, each a link to these, whichever are shown. */
function SinceAnswer({ filters, search }: { readonly filters: Asked; readonly search: Search }) {
  const { since_baseline: _, ...query } = filters;
  const { data } = useQuery({
    queryKey: ["group", "list", query],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/failures/groups", {
          params: { query: { limit: MOST_COUNTED, ...query } },
        }),
      ),
  });
  if (!data) return null;
  const groups = data.items;
  const of = (since: Since) => groups.filter((one) => one.since_baseline === since);
  const counting = of("new").filter(({ avoidable }) => avoidable > 0).length;
  return (
    <p className="answer">
      Since the baseline{data.next_page_token ? `, of ${count(groups.length)} groups` : ""}:{" "}
      {SINCES.map((since, place) => (
        <span key={since}>
          {place > 0 && ", "}
          <Link to="." search={{ ...search, since_baseline: since }}>
            {count(of(since).length)} {SINCE_WORDS[since]}
          </Link>
          {since === "new" && ` (${count(counting)} with avoidable ones)`}
        </span>
      ))}
      .
    </p>
  );
}
