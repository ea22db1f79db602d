import { Link, useNavigate } from "@tanstack/react-router";
import { api, body, type Schemas } from "../../api/client";
import { type Column, DataTable } from "../../components/DataTable";
import { Mark } from "../../components/Mark";
import { count, moment } from "../../components/numbers";
import { Progress } from "../../components/Progress";
import { Empty, Loading, Refused } from "../../components/States";
import { useList } from "../../lists/useList";
import { serviceAddress } from "../../service";
import { useTitle } from "../../shell/useTitle";
import { Actions } from "../campaigns/Actions";
import { lookOfSearch } from "../campaigns/state";
import { NewLink } from "../compose/NewLink";

type Row = Schemas["StudyInList"];

const COLUMNS: readonly Column<Row>[] = [
  {
    id: "name",
    title: "Study",
    width: "minmax(220px, 1fr)",
    cell: ({ id, name }) => (
      <Link to="/studies/$id" params={{ id }} search={{}}>
        {name || id}
      </Link>
    ),
  },
  {
    id: "state",
    title: "State",
    width: "120px",
    cell: ({ state, request }) => <Mark {...lookOfSearch(state, request)} />,
  },
  {
    id: "campaigns",
    title: "Campaigns",
    width: "200px",
    cell: ({ id, campaigns }) => (
      <Link to="/campaigns" search={{ study: id }}>
        {Object.entries(campaigns)
          .map(([state, number]) => `${number} ${state}`)
          .join(", ")}
      </Link>
    ),
  },
  {
    id: "progress",
    title: "Simulations",
    width: "170px",
    cell: ({ simulations, budget }) => <Progress done={simulations} of={budget} />,
  },
  {
    id: "avoidable",
    title: "Count",
    hint: "Simulations with an avoidable failure: an ego was at fault, and a careful driver avoids it",
    width: "80px",
    numeric: true,
    cell: ({ counts }) => (
      <span className={counts.avoidable ? "bad" : "quiet"}>
        {counts.avoidable === null ? "unknown" : count(counts.avoidable)}
      </span>
    ),
  },
  {
    id: "others",
    title: "Others",
    hint: "Simulations with other failures only",
    width: "80px",
    numeric: true,
    cell: ({ counts }) => count(counts.violating - (counts.avoidable ?? 0)),
  },
  {
    id: "updated",
    title: "Last change",
    width: "170px",
    cell: ({ updated_at }) => moment(updated_at),
  },
  {
    id: "actions",
    title: "",
    width: "132px",
    cell: ({ id, name, state, request }) => (
      <Actions kind="study" id={id} name={name} state={state} request={request} small />
    ),
  },
];

export function Studies() {
  useTitle("Studies");
  const navigate = useNavigate();
  const { query, rows, more } = useList<Row>(["study", "list"], async (page_token) =>
    body(
      await api.GET("/api/v1/studies", {
        params: { query: { limit: 100, ...(page_token ? { page_token } : {}) } },
      }),
    ),
  );
  return (
    <>
      <div className="head">
        <h1>Studies</h1>
        <span className="answer">Scenarios × ADSs × methods, each repeated.</span>
        <div className="actions">
          <NewLink to="/studies/new">New study</NewLink>
        </div>
      </div>
      {query.isPending ? (
        <Loading />
      ) : query.isError ? (
        <Refused error={query.error} onRepeat={() => void query.refetch()} />
      ) : rows.length === 0 ? (
        <Empty
          title="No study yet"
          command={`drivora study run study.yaml --server ${serviceAddress()}`}
        >
          <p>A study runs a campaign for each scenario, ADS, method and repetition.</p>
          <NewLink to="/studies/new" isShort>
            Compose one here
          </NewLink>
        </Empty>
      ) : (
        <DataTable
          label="Studies"
          columns={COLUMNS}
          rows={rows}
          idOf={({ id }) => id}
          onOpen={({ id }) => void navigate({ to: "/studies/$id", params: { id }, search: {} })}
          onEnd={more}
        />
      )}
    </>
  );
}
