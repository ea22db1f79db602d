import { useQuery } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../api/client";
import { Copy } from "../../components/Copy";
import { moment } from "../../components/numbers";
import { Prose } from "../../components/Prose";

/** The document of a campaign, and the software that determines its search. */
export function Settings({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const tester = useQuery({
    queryKey: ["testers", "list"],
    queryFn: async () => body(await api.GET("/api/v1/testers")),
    select: ({ items }) => items.find(({ name }) => name === campaign.tester),
  });
  const document = JSON.stringify(campaign.document, null, 2);
  return (
    <div className="two">
      <section className="panel">
        <header>
          <h2>Document</h2>
          <span className="quiet">as posted, with defaults filled in</span>
          <span className="actions">
            <Copy text={document} label="Copy" />
          </span>
        </header>
        {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a part that scrolls is reached by keyboard */}
        <pre className="inside document" tabIndex={0}>
          {document}
        </pre>
      </section>
      <section className="panel">
        <header>
          <h2>Search</h2>
        </header>
        <dl className="inside facts-list">
          <dt>Method</dt>
          <dd>
            {tester.data?.title ?? campaign.tester}
            {tester.data && (
              <p className="quiet">
                <Prose text={tester.data.description} />
              </p>
            )}
          </dd>
          <dt>Queued</dt>
          <dd>{moment(campaign.created_at)}</dd>
          <dt>Started</dt>
          <dd>{moment(campaign.started_at) || "not yet"}</dd>
          <dt>Ended</dt>
          <dd>{moment(campaign.ended_at) || "not yet"}</dd>
          <dt>Network</dt>
          <dd>
            {campaign.town}{" "}
            <code title={campaign.network_sha256}>{campaign.network_sha256.slice(0, 12)}</code>
          </dd>
          {Object.entries(campaign.versions).map(([name, version]) => (
            <div key={name} style={{ display: "contents" }}>
              <dt>{name}</dt>
              <dd>{version}</dd>
            </div>
          ))}
        </dl>
      </section>
    </div>
  );
}
