import { useQuery } from "@tanstack/react-query";
import { Link, useNavigate, useSearch } from "@tanstack/react-router";
import { useState } from "react";
import { firstOf, valuesOf } from "../../address";
import { api, body, type Schemas } from "../../api/client";
import { DataTable } from "../../components/DataTable";
import { Filters } from "../../components/Filters";
import { Empty, Loading, Refused } from "../../components/States";
import { News } from "../../lists/News";
import { useLiveList } from "../../lists/useLiveList";
import { serviceAddress } from "../../service";
import { useTitle } from "../../shell/useTitle";
import { NewLink } from "../compose/NewLink";
import { COLUMNS } from "./columns";
import { STATES } from "./state";

type Campaign = Schemas["CampaignSummary"];
type State = Schemas["CampaignState"];

const FILTERS = [
  { name: "state", title: "State", values: STATES },
  { name: "study", title: "Study", single: true },
] as const;

const idOf = ({ id }: Campaign) => id;
const isState = (value: string): value is State => STATES.some((state) => state === value);

export function Campaigns() {
  useTitle("Campaigns");
  const search = useSearch({ from: "/campaigns" });
  const navigate = useNavigate();
  const [selected, setSelected] = useState<ReadonlySet<string>>(new Set());
  const state = valuesOf(search, "state").filter(isState);
  const study = firstOf(search, "study");
  const filters = { ...(state.length ? { state } : {}), ...(study ? { study } : {}) };
  const [held, setHeld] = useState(false);
  const { query, rows, left, news, insertNews, more } = useLiveList<Campaign>({
    key: ["campaign", filters],
    kind: "campaign",
    ask: async (page_token) =>
      body(
        await api.GET("/api/v1/campaigns", {
          params: { query: { limit: 100, ...filters, ...(page_token ? { page_token } : {}) } },
        }),
      ),
    idOf,
    held,
    newestFirst: true,
  });
  const compare = (ids: readonly string[]) =>
    void navigate({ to: "/compare", search: { campaign: ids } });
  return (
    <>
      <div className="head">
        <h1>Campaigns</h1>
        <Running />
        <div className="actions">
          <NewLink to="/campaigns/new">New campaign</NewLink>
          <button
            type="button"
            disabled={selected.size < 2}
            title="Select rows with x, or with Ctrl and a click"
            onClick={() => compare([...selected])}
          >
            Compare {selected.size > 1 ? `${selected.size} selected` : "selected"}
          </button>
        </div>
      </div>
      <Filters filters={FILTERS} search={search} />
      {query.isPending ? (
        <Loading />
      ) : query.isError ? (
        <Refused error={query.error} onRepeat={() => void query.refetch()} />
      ) : rows.length === 0 ? (
        <Empty
          title={Object.keys(filters).length > 0 ? "No campaign matches" : "No campaign yet"}
          command={`drivora campaign run campaign.yaml --server ${serviceAddress()}`}
        >
          <p>
            A campaign searches for failures of an ADS.
            {Object.keys(filters).length > 0 && " Remove a filter to see others."}
          </p>
          <NewLink to="/campaigns/new" isShort>
            Compose one here
          </NewLink>
        </Empty>
      ) : (
        <div className="with-news">
          <News news={news} onInsert={insertNews} />
          <DataTable
            label="Campaigns"
            columns={COLUMNS}
            rows={rows}
            idOf={idOf}
            left={left}
            onHold={setHeld}
            onOpen={({ id }) => void navigate({ to: "/campaigns/$id", params: { id }, search: {} })}
            selected={selected}
            onSelect={setSelected}
            onCompare={compare}
            onEnd={more}
          />
        </div>
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
