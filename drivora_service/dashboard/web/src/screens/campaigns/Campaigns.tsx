import { useQuery } from "@tanstack/react-query";
import { Link, useNavigate, useSearch } from "@tanstack/react-router";
import { firstOf, valuesOf } from "../../address";
import { api, body, type Schemas } from "../../api/client";
import { DataTable } from "../../components/DataTable";
import { Filters } from "../../components/Filters";
import { Empty, Loading, Refused } from "../../components/States";
import { useList } from "../../lists/useList";
import { useTitle } from "../../shell/useTitle";
import { COLUMNS } from "./columns";
import { STATES } from "./state";

type Campaign = Schemas["CampaignSummary"];
type State = Schemas["CampaignState"];

const FILTERS = [
  { name: "state", title: "State", values: STATES },
  { name: "study", title: "Study", single: true },
] as const;

const isState = (value: string): value is State => STATES.some((state) => state === value);

export function Campaigns() {
  useTitle("Campaigns");
  const search = useSearch({ from: "/campaigns" });
  const navigate = useNavigate();
  const state = valuesOf(search, "state").filter(isState);
  const study = firstOf(search, "study");
  const filters = { ...(state.length ? { state } : {}), ...(study ? { study } : {}) };
  const { query, rows, more } = useList<Campaign>(
    ["campaign", "list", filters],
    async (page_token) =>
      body(
        await api.GET("/api/v1/campaigns", {
          params: { query: { limit: 100, ...filters, ...(page_token ? { page_token } : {}) } },
        }),
      ),
  );
  return (
    <>
      <div className="head">
        <h1>Campaigns</h1>
        <Running />
      </div>
      <Filters filters={FILTERS} search={search} />
      {query.isPending ? (
        <Loading />
      ) : query.isError ? (
        <Refused error={query.error} onRepeat={() => void query.refetch()} />
      ) : rows.length === 0 ? (
        <Empty
          title="No campaign matches"
          command="drivora campaign run campaign.yaml --server URL"
        >
          <p>Begin a search for failures of an ADS, or remove a filter.</p>
        </Empty>
      ) : (
        <DataTable
          label="Campaigns"
          columns={COLUMNS}
          rows={rows}
          idOf={({ id }) => id}
          onOpen={({ id }) => void navigate({ to: "/campaigns/$id", params: { id }, search: {} })}
          onEnd={more}
        />
      )}
    </>
  );
}

/** The answer first: what is searching now. */
function Running() {
  const { data } = useQuery({
    queryKey: ["campaign", "list", "running"],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/campaigns", {
          params: { query: { state: ["running"], limit: 500 } },
        }),
      ),
  });
  if (!data) return null;
  const rate = data.items.reduce((sum, { rate }) => sum + (rate ?? 0), 0);
  return (
    <span className="answer">
      {data.items.length === 0 ? (
        "None is running."
      ) : (
        <>
          <Link to="/campaigns" search={{ state: "running" }}>
            {data.items.length} running
          </Link>
          {rate > 0 && `, ${rate.toFixed(1)} simulations a second`}
        </>
      )}
    </span>
  );
}
