import { memo } from "react";
import type { Numbers } from "../../../components/charts/export";
import { Figure } from "../../../components/charts/Figure";
import { GeneGrid } from "./GeneGrid";
import { binRange, type Family } from "./genes";

const TITLES: Readonly<Record<string, string>> = {
  ego: "Egos",
  vehicle: "Vehicles",
  walker: "Walkers",
  obstacle: "Obstacles",
  weather: "Weather",
  lights: "Lights",
};

/** The genes of blocks of the same part of a scenario, as a figure. */
export const GeneFamily = memo(function GeneFamily({
  family,
  file,
}: {
  readonly family: Family;
  readonly file: string;
}) {
  const title = TITLES[family.name] ?? family.name;
  return (
    <div className={family.blocks.length > 2 ? "whole" : undefined}>
      <Figure title={title} file={file} numbers={numbersOf(family)}>
        {(width) => <GeneGrid family={family} label={`Values of genes: ${title}`} width={width} />}
      </Figure>
    </div>
  );
});

function numbersOf({ rows }: Family): Numbers {
  return {
    columns: ["block", "gene", "unit", "from", "to", "simulations", "failing", "avoidable"],
    rows: rows.flatMap(({ cells }) =>
      cells.flatMap((gene) =>
        gene
          ? gene.simulations.map((simulations, bin) => [
              gene.block,
              gene.name,
              gene.unit,
              ...binRange(gene, bin),
              simulations,
              gene.failing[bin] ?? 0,
              gene.avoidable[bin] ?? 0,
            ])
          : [],
      ),
    ),
  };
}
