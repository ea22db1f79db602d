import { useQuery } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../api/client";
import { Loading, Refused } from "../../components/States";
import { PlacesMap } from "./PlacesMap";

/** How much a campaign has tried, and where it has failed. */
export function Coverage({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  return (
    <div className="two wide-first">
      <section className="panel">
        <div className="inside">
          <PlacesMap campaign={campaign} />
        </div>
      </section>
      <section className="panel">
        <header>
          <h2>Coverage</h2>
        </header>
        <div className="inside">
          <Shares campaign={campaign} />
        </div>
      </section>
    </div>
  );
}

const EVERY = 25;

function Shares({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const version =
    campaign.state === "running" ? Math.floor(campaign.simulations / EVERY) : campaign.simulations;
  const query = useQuery({
    // Figures take their time: they are asked for after each 25 simulations, not with each event.
    queryKey: ["figures", campaign.id, campaign.state, version],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/campaigns/{campaign_id}/figures", {
          params: { path: { campaign_id: campaign.id } },
        }),
      ),
  });
  if (query.isPending) return <Loading rows={4} />;
  if (query.isError) return <Refused error={query.error} />;
  const { figures, note } = query.data;
  if (!figures) return <p className="quiet">{note}</p>;
  return (
    <dl className="tried">
      <Share
        title="Gene space"
        value={figures.gene_coverage}
        text="of all combinations of two genes' levels were tried"
      />
      <Share
        title="Road network"
        value={figures.network_coverage ?? null}
        text="of the drivable lanes, by length, had actors placed or planned on them"
      />
      <Amount
        title="Situations"
        value={figures.situations}
        text="in which failures occurred, counted by their distance from each other"
      />
      <Amount
        title="Groups"
        value={figures.groups}
        text="of similar failures; they are known when the campaign has ended"
      />
    </dl>
  );
}

function Share({
  title,
  value,
  text,
}: {
  readonly title: string;
  readonly value: number | null;
  readonly text: string;
}) {
  return (
    <div>
      <dt>{title}</dt>
      <dd>
        {value === null ? (
          <span className="quiet">not known</span>
        ) : (
          <>
            <strong>{(value * 100).toFixed(1)} %</strong> {text}
            <span className="rail" aria-hidden="true">
              <span style={{ width: `${Math.min(value, 1) * 100}%` }} />
            </span>
          </>
        )}
      </dd>
    </div>
  );
}

function Amount({
  title,
  value,
  text,
}: {
  readonly title: string;
  readonly value: number | null;
  readonly text: string;
}) {
  return (
    <div>
      <dt>{title}</dt>
      <dd>
        {value === null ? <span className="quiet">not known yet</span> : <strong>{value}</strong>}{" "}
        {text}
      </dd>
    </div>
  );
}
