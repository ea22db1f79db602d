import type { Schemas } from "../../../api/client";
import { binText } from "./genes";

type Gene = Schemas["GeneCoverage"];

/** Pixels of the least bar, so that a single simulation is seen. */
const LEAST_PX = 2;
const WIDEST_PX = 18;

/** The bins of a gene as bars: avoidable failures at the foot, other failures on them, then the rest. */
export function BinStrip({
  gene,
  most,
  width,
  height,
}: {
  readonly gene: Gene;
  /** Simulations of the highest bar. */
  readonly most: number;
  readonly width: number;
  readonly height: number;
}) {
  const bins = gene.simulations.length;
  const slot = width / bins;
  // Bars of whole numbers and categories stand apart: there is nothing between their values.
  const wide =
    gene.kind === "continuous" ? slot - Math.min(slot * 0.12, 1) : Math.min(slot * 0.7, WIDEST_PX);
  const high = (count: number) =>
    count > 0 ? Math.max((count / Math.max(most, 1)) * height, LEAST_PX) : 0;
  return (
    <>
      <line className="base" x2={width} y1={height} y2={height} />
      {gene.simulations.map((simulations, bin) => {
        const avoidable = gene.avoidable[bin] ?? 0;
        const others = (gene.failing[bin] ?? 0) - avoidable;
        const parts = [
          ["counting", high(avoidable)],
          ["failing", high(others)],
          ["passed", high(simulations - avoidable - others)],
        ] as const;
        let top = height;
        return (
          // biome-ignore lint/suspicious/noArrayIndexKey: bins in their order
          <g key={bin} className="bin">
            <title>{`${gene.name} of ${gene.block}, ${binText(gene, bin)}: ${simulations} simulations, ${avoidable} with an avoidable failure, ${others} with others`}</title>
            <rect className="sensor" x={bin * slot} width={slot} y={-2} height={height + 4} />
            {parts.map(([look, size]) => {
              top -= size;
              // Hollow bars keep their outline inside.
              const rim = look === "failing" ? 0.5 : 0;
              return (
                size > 0 && (
                  <rect
                    key={look}
                    className={look}
                    x={(bin + 0.5) * slot - wide / 2 + rim}
                    width={wide - 2 * rim}
                    y={top + rim}
                    height={size - 2 * rim}
                  />
                )
              );
            })}
          </g>
        );
      })}
    </>
  );
}
