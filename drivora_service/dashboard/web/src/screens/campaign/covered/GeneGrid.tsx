import { BinStrip } from "./BinStrip";
import { type Family, rangeText } from "./genes";

const ROW_PX = 28;
const HEAD_PX = 22;
const NAME_PX = 128;
const RANGE_PX = 104;
const UNIT_PX = 34;
const MOST_PX = 54;
const BETWEEN_PX = 14;
const WIDEST_PX = 420;

/** Genes in rows, blocks in columns: the bins of each as a strip of bars. */
export function GeneGrid({
  family: { blocks, rows },
  label,
  width,
}: {
  readonly family: Family;
  readonly label: string;
  readonly width: number;
}) {
  const left = NAME_PX + RANGE_PX + UNIT_PX + BETWEEN_PX;
  const room = (width - left - MOST_PX) / blocks.length;
  const strip = Math.max(Math.min(room, WIDEST_PX) - BETWEEN_PX, 20);
  const leftOf = (place: number) => left + place * (strip + BETWEEN_PX);
  const height = HEAD_PX + rows.length * ROW_PX;
  return (
    <svg className="chart genes" width={width} height={height} role="img" aria-label={label}>
      <g className="heads" transform={`translate(0,${HEAD_PX - 8})`}>
        <text className="title">gene</text>
        <text className="title" x={NAME_PX + RANGE_PX} textAnchor="end">
          range
        </text>
        {blocks.map((block, place) => (
          <text key={block} className="title" x={leftOf(place)}>
            {block}
          </text>
        ))}
        <text className="title" x={leftOf(blocks.length) + MOST_PX - BETWEEN_PX} textAnchor="end">
          highest
        </text>
      </g>
      {rows.map((row, place) => (
        <g
          key={`${row.name} ${row.low} ${row.high}`}
          transform={`translate(0,${HEAD_PX + place * ROW_PX})`}
        >
          <text className="gene" y={ROW_PX / 2} dy="0.32em">
            {row.name}
          </text>
          <text x={NAME_PX + RANGE_PX} y={ROW_PX / 2} dy="0.32em" textAnchor="end">
            {rangeText(row)}
          </text>
          <text className="title" x={NAME_PX + RANGE_PX + 5} y={ROW_PX / 2} dy="0.32em">
            {row.unit}
          </text>
          {row.cells.map((gene, block) =>
            gene ? (
              <g key={gene.block} transform={`translate(${leftOf(block)},3)`}>
                <BinStrip gene={gene} most={row.most} width={strip} height={ROW_PX - 6} />
              </g>
            ) : null,
          )}
          <text
            x={leftOf(blocks.length) + MOST_PX - BETWEEN_PX}
            y={ROW_PX / 2}
            dy="0.32em"
            textAnchor="end"
          >
            {row.most}
          </text>
        </g>
      ))}
    </svg>
  );
}
