import type { Schemas } from "../../api/client";

type Block = Schemas["Block"];

/** A gene that differs between an evaluation and a parent of it. */
export interface Change {
  readonly block: string;
  readonly gene: string;
  readonly unit: string;
  readonly from: number;
  readonly to: number;
  /** Size of the change against the range of the gene. */
  readonly share: number;
}

/** Returns the genes that differ, the greatest change first. */
export function changesBetween(
  parent: readonly Block[],
  child: readonly Block[],
): readonly Change[] {
  const before = new Map(
    parent.flatMap(({ name, genes }) => genes.map((gene) => [`${name} ${gene.name}`, gene.value])),
  );
  return child
    .flatMap(({ name, genes }) =>
      genes.flatMap((gene): readonly Change[] => {
        const from = before.get(`${name} ${gene.name}`);
        if (from === undefined || from === gene.value) return [];
        const range = gene.high - gene.low;
        const share = range > 0 ? Math.abs(gene.value - from) / range : 1;
        return [{ block: name, gene: gene.name, unit: gene.unit, from, to: gene.value, share }];
      }),
    )
    .sort((a, b) => b.share - a.share);
}
