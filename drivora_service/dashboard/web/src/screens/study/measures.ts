import type { Schemas } from "../../api/client";

type Figures = Schemas["CampaignFigures"];

/** A figure of a campaign by which methods and ADSs are compared; names as in the API. */
export interface Measure {
  readonly name: string;
  readonly title: string;
  readonly value: (figures: Figures) => number | null;
}

export const MEASURES: readonly Measure[] = [
  {
    name: "avoidable",
    title: "simulations with a failure that counts",
    value: ({ avoidable }) => avoidable,
  },
  {
    name: "first_avoidable",
    title: "simulations to the first failure that counts",
    value: ({ first_avoidable }) => first_avoidable,
  },
  {
    name: "avoidable_kinds",
    title: "kinds of failures that count",
    value: ({ avoidable_kinds }) => avoidable_kinds,
  },
  {
    name: "avoidable_situations",
    title: "situations with a failure that counts",
    value: ({ avoidable_situations }) => avoidable_situations,
  },
  { name: "at_fault", title: "simulations at fault", value: ({ at_fault }) => at_fault },
  { name: "failing", title: "simulations with a failure", value: ({ failing }) => failing },
  { name: "kinds", title: "kinds of failures", value: ({ kinds }) => kinds },
  { name: "situations", title: "situations with a failure", value: ({ situations }) => situations },
  {
    name: "first_failure",
    title: "simulations to the first failure",
    value: ({ first_failure }) => first_failure,
  },
  {
    name: "gene_coverage",
    title: "coverage of the gene space",
    value: ({ gene_coverage }) => gene_coverage,
  },
  {
    name: "network_coverage",
    title: "coverage of the road network",
    value: ({ network_coverage }) => network_coverage ?? null,
  },
  {
    name: "law_coverage",
    title: "coverage of violations of traffic laws",
    value: ({ law_coverage }) => law_coverage ?? null,
  },
  {
    name: "unchanged_share",
    title: "share of candidates with their parent's run",
    value: ({ unchanged_share }) => unchanged_share ?? null,
  },
  {
    name: "own_share",
    title: "own time over simulation time",
    value: ({ own_share }) => own_share,
  },
];

const FIRST = MEASURES[0] as Measure;

export function measureOf(name: string): Measure {
  return MEASURES.find((measure) => measure.name === name) ?? FIRST;
}

/** Returns the class of a method's look: the same on every figure of a screen. */
export function lookOf(names: readonly string[], name: string): string {
  return `series-${Math.max(names.indexOf(name), 0) % 6}`;
}
