import type { Schemas } from "../../../api/client";
import { tickText } from "../../../components/charts/scale";

type Gene = Schemas["GeneCoverage"];

/** A gene that several blocks have, with the same range in each. */
export interface GeneRow {
  readonly name: string;
  readonly unit: string;
  readonly kind: Gene["kind"];
  readonly low: number;
  readonly high: number;
  /** The gene of each block; undefined where the block has none. */
  readonly cells: readonly (Gene | undefined)[];
  /** Simulations of the fullest bin of all cells. */
  readonly most: number;
}

/** Blocks of the same part of a scenario: `vehicle_0`, `vehicle_1`. */
export interface Family {
  readonly name: string;
  readonly blocks: readonly string[];
  readonly rows: readonly GeneRow[];
}

/** Returns genes by parts of a scenario, and there by names, all in their order. */
export function familiesOf(genes: readonly Gene[]): readonly Family[] {
  const families = grouped(genes, ({ block }) => block.replace(/_\d+$/, ""));
  return [...families].map(([name, members]) => {
    const blocks = [...new Set(members.map(({ block }) => block))];
    const rows = grouped(members, ({ name, unit, kind, low, high }) =>
      JSON.stringify([name, unit, kind, low, high]),
    );
    return { name, blocks, rows: [...rows.values()].flatMap((alike) => rowOf(alike, blocks)) };
  });
}

function grouped(genes: readonly Gene[], keyOf: (gene: Gene) => string) {
  const found = new Map<string, Gene[]>();
  for (const gene of genes) {
    const group = found.get(keyOf(gene));
    if (group) group.push(gene);
    else found.set(keyOf(gene), [gene]);
  }
  return found;
}

function rowOf(alike: readonly Gene[], blocks: readonly string[]): readonly GeneRow[] {
  const [first] = alike;
  if (!first) return [];
  const { name, unit, kind, low, high } = first;
  const cells = blocks.map((block) => alike.find((gene) => gene.block === block));
  const most = Math.max(0, ...alike.flatMap(({ simulations }) => simulations));
  return [{ name, unit, kind, low, high, cells, most }];
}

/** Returns the least and the greatest value of a bin; of whole numbers both belong to it. */
export function binRange(
  { kind, low, high, simulations }: Pick<Gene, "kind" | "low" | "high" | "simulations">,
  bin: number,
): readonly [number, number] {
  const bins = simulations.length;
  if (kind === "continuous") {
    const width = (high - low) / bins;
    return [low + bin * width, low + (bin + 1) * width];
  }
  // A whole number is in the bin of the middle of its cell, as the service counts it.
  const values = high - low + 1;
  return [
    low + Math.ceil((bin * values) / bins - 0.5),
    low + Math.ceil(((bin + 1) * values) / bins - 0.5) - 1,
  ];
}

/** Returns the values of a bin in words: `2–3.6 m/s`, `4`, `category 4`. */
export function binText(gene: Gene, bin: number): string {
  const [from, to] = binRange(gene, bin);
  const text = from === to ? tickText(from) : `${tickText(from)} to ${tickText(to)}`;
  const many = from === to ? "category" : "categories";
  return gene.kind === "category" ? `${many} ${text}` : `${text} ${gene.unit}`.trim();
}

/** Returns the range of a gene in words; categories have no order, so that they are counted. */
export function rangeText({ kind, low, high }: Pick<Gene, "kind" | "low" | "high">): string {
  if (kind === "category") return `${high - low + 1} categories`;
  return `${tickText(low)} to ${tickText(high)}`;
}

/** Returns how many bins of genes have a simulation, and how many there are. */
export function triedOf(genes: readonly Gene[]): { readonly tried: number; readonly bins: number } {
  const counts = genes.flatMap(({ simulations }) => simulations);
  return { tried: counts.filter((count) => count > 0).length, bins: counts.length };
}
