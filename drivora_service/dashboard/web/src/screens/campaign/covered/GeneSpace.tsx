import { useSearch } from "@tanstack/react-router";
import { useMemo } from "react";
import { firstOf } from "../../../address";
import type { Schemas } from "../../../api/client";
import { Choice } from "../../../components/Choice";
import { count } from "../../../components/numbers";
import { GeneFamily } from "./GeneFamily";
import { familiesOf, triedOf } from "./genes";

type Gene = Schemas["GeneCoverage"];

/** Which values of the genes were tried, and where failures are. */
export function GeneSpace({
  campaign,
  genes,
}: {
  readonly campaign: Schemas["Campaign"];
  readonly genes: readonly Gene[];
}) {
  const search = useSearch({ from: "/campaigns/$id" });
  const seeds = [...new Set(genes.map(({ seed_number }) => seed_number))];
  const seed = seeds.find((number) => String(number) === firstOf(search, "seed")) ?? seeds[0];
  const own = useMemo(() => genes.filter(({ seed_number }) => seed_number === seed), [genes, seed]);
  const families = useMemo(() => familiesOf(own), [own]);
  const { tried, bins } = triedOf(own);
  return (
    <section className="panel">
      <header>
        <h2>Gene space</h2>
        {seeds.length > 1 && (
          <Choice
            name="seed"
            title="Seed scenario"
            value={String(seed)}
            search={search}
            options={seeds.map((number) => ({
              value: String(number),
              text: campaign.seeds[number]?.name || `scenario ${number}`,
            }))}
          />
        )}
      </header>
      <div className="inside gene-families">
        {own.length === 0 ? (
          <p className="quiet">The genes of this campaign are not known any more.</p>
        ) : (
          <p className="whole">
            {tried === bins ? "All" : `${count(tried)} of`} {count(bins)} bins of {own.length} genes
            have a simulation. <Legend />
          </p>
        )}
        {families.map((family) => (
          <GeneFamily
            key={family.name}
            family={family}
            file={`${campaign.id}-genes-${seeds.length > 1 ? `${seed}-` : ""}${family.name}`}
          />
        ))}
      </div>
    </section>
  );
}

function Legend() {
  return (
    <span className="quiet gene-legend">
      Height: simulations, to the same scale in a row.{" "}
      <span className="sample counting">with an avoidable failure</span>{" "}
      <span className="sample failing">with another failure</span>{" "}
      <span className="sample passed">without</span>
    </span>
  );
}
