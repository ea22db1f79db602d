import { Link } from "@tanstack/react-router";
import type { ReactNode } from "react";
import type { Schemas } from "../../../api/client";
import { Loading, Refused } from "../../../components/States";
import { useFigures } from "./useCovered";

/** How much a campaign has tried and found, in numbers. */
export function Amounts({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  return (
    <section className="panel">
      <header>
        <h2>Amounts</h2>
      </header>
      <div className="inside">
        <Figures campaign={campaign} />
      </div>
    </section>
  );
}

function Figures({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const query = useFigures(campaign);
  if (query.isPending) return <Loading rows={4} />;
  if (query.isError) return <Refused error={query.error} />;
  const { figures, note } = query.data;
  if (!figures) return <p className="quiet">{note}</p>;
  return (
    <dl className="tried">
      <Share title="Gene space" value={figures.gene_coverage}>
        of all combinations of two genes' levels tried
      </Share>
      <Share title="Road network" value={figures.network_coverage ?? null}>
        of the drivable lanes' length used by any actor
      </Share>
      <Share title="Traffic laws" value={figures.law_coverage ?? null}>
        of the ways to violate them shown by some run
      </Share>
      <Amount title="Situations" value={figures.situations}>
        of failures near each other
      </Amount>
      <Amount
        title="Groups"
        value={
          figures.groups === null ? (
            <span className="quiet">not yet</span>
          ) : figures.groups === 0 ? (
            0
          ) : (
            <Link to="/failures" search={{ campaign: campaign.id }}>
              {figures.groups}
            </Link>
          )
        }
      >
        of similar failures{figures.groups === null && "; grouped when the campaign has ended"}
      </Amount>
    </dl>
  );
}

function Share({
  title,
  value,
  children,
}: {
  readonly title: string;
  readonly value: number | null;
  readonly children: ReactNode;
}) {
  const percent = value === null ? null : `${(value * 100).toFixed(1)} %`;
  return (
    <Amount title={title} value={percent}>
      {children}
      {value !== null && (
        <span className="rail" aria-hidden="true">
          <span style={{ width: `${Math.min(value, 1) * 100}%` }} />
        </span>
      )}
    </Amount>
  );
}

function Amount({
  title,
  value,
  children,
}: {
  readonly title: string;
  readonly value: ReactNode;
  readonly children: ReactNode;
}) {
  return (
    <div>
      <dt>{title}</dt>
      <dd className="number">{value ?? <span className="quiet">not known</span>}</dd>
      <dd>{children}</dd>
    </div>
  );
}
