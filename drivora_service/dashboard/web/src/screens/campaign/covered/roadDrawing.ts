import type { Schemas } from "../../../api/client";
import { linePath, type Plan, shownBy, touches } from "../../../components/charts/placeMap";
import type { LaneIndex, LanePlace } from "../../../roads/laneIndex";
import { runsOf, type Use } from "./laneUse";

/** Lines of one look, in one path: a network has thousands of pieces. */
export interface Drawn {
  readonly look: string;
  /** Pixels. */
  readonly thick: number;
  readonly path: string;
}

/** Share of a lane's width that is drawn, so that neighbours stay apart. */
const USED_SHARE = 0.85;
/** Unused lanes are thinner, so that they are told apart without colours. */
const UNUSED_SHARE = 0.4;

/** Returns what is drawn of the lanes in sight: the unused ones first, the most used ones last. */
export function drawingOf(
  index: LaneIndex,
  counted: ReadonlyMap<string, Schemas["LaneCoverage"]>,
  use: Use,
  shadeOf: (count: number) => number | undefined,
  plan: Plan,
  width: number,
): readonly Drawn[] {
  const paths = new Map<string, { readonly order: number; readonly drawn: Drawn }>();
  const add = (order: number, look: string, thick: number, path: string) => {
    const key = `${look} ${thick}`;
    const before = paths.get(key)?.drawn.path ?? "";
    paths.set(key, { order, drawn: { look, thick, path: before + path } });
  };
  const shown = shownBy(plan, width);
  for (const lane of index.byId.values()) {
    if (!touches(lane.shape, shown)) continue;
    const thick = (share: number, least: number) =>
      Number(Math.max(lane.width * plan.scale * share, least).toFixed(1));
    const line = index.lineOf(lane);
    add(-1, "unused", thick(UNUSED_SHARE, 1), linePath(line, plan));
    for (const run of runsOf(line, counted.get(lane.id)?.[use] ?? [], shadeOf))
      add(run.shade, `use-${run.shade}`, thick(USED_SHARE, 2), linePath(run.line, plan));
  }
  return [...paths.values()].sort((a, b) => a.order - b.order).map(({ drawn }) => drawn);
}

const AROUND = [
  [0, 0],
  [3, 0],
  [-3, 0],
  [0, 3],
  [0, -3],
  [6, 0],
  [-6, 0],
  [0, 6],
  [0, -6],
] as const;

/** Returns the lane at pixels of a plan, or a few beside them: lanes are narrow on a wide plan. */
export function laneNear(
  index: LaneIndex,
  plan: Plan,
  left: number,
  top: number,
): LanePlace | undefined {
  // The legend is below the plan.
  if (top > plan.height) return undefined;
  for (const [across, down] of AROUND) {
    const found = index.at(...plan.from(left + across, top + down));
    if (found) return found;
  }
  return undefined;
}
