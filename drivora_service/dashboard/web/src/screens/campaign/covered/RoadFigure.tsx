import { Link } from "@tanstack/react-router";
import { memo, useMemo } from "react";
import type { Schemas } from "../../../api/client";
import type { CountClass } from "../../../components/charts/countClasses";
import type { Numbers } from "../../../components/charts/export";
import { Figure } from "../../../components/charts/Figure";
import type { Bounds } from "../../../components/charts/placeMap";
import { LaneIndex } from "../../../roads/laneIndex";
import { lengthOf } from "../../../roads/lines";
import type { FailurePlace } from "./failurePlaces";
import { LaneUseMap } from "./LaneUseMap";
import { type Area, piecesOf, type Use, usedBounds } from "./laneUse";

type Coverage = Schemas["NetworkCoverage"];

/** Room around what is shown, as a share of its extent. */
const AROUND = 0.08;

export interface RoadFigureProps {
  /** Id of the campaign. */
  readonly campaign: string;
  readonly coverage: Coverage;
  readonly geometry: Schemas["NetworkGeometry"];
  readonly classes: readonly CountClass[];
  readonly use: Use;
  readonly area: Area;
  /** Failures of the campaign, on all networks. */
  readonly places: readonly FailurePlace[];
}

/** How often the lanes of one network were used, as a figure. */
export const RoadFigure = memo(function RoadFigure({
  campaign,
  coverage,
  geometry,
  classes,
  use,
  area,
  places,
}: RoadFigureProps) {
  const { network, share, ego_share, lanes } = coverage;
  const index = useMemo(
    () => new LaneIndex(geometry.lanes.filter((lane) => lane.drivable)),
    [geometry],
  );
  const own = useMemo(() => places.filter(({ town }) => town === network), [places, network]);
  const bounds = useMemo(() => {
    const whole = geometry.bounds as unknown as Bounds;
    if (area === "network") return whole;
    const failed = own.map(({ x, y }) => [x, y]);
    return usedBounds(lanes, use, (id) => lineOf(index, id), failed, AROUND) ?? whole;
  }, [geometry, index, lanes, use, area, own]);
  const numbers = useMemo(() => numbersOf(coverage, index), [coverage, index]);
  return (
    <Figure
      title={network}
      note={
        <span className="answer">
          Egos used <strong>{percent(ego_share)}</strong> of the drivable lanes of{" "}
          <Link to="/networks/$name" params={{ name: network }} search={{}}>
            {network}
          </Link>
          , by length; all actors <strong>{percent(share)}</strong>.
        </span>
      }
      file={`${campaign}-roads-${network}`}
      numbers={numbers}
    >
      {(width) => (
        <LaneUseMap
          network={network}
          lanes={lanes}
          index={index}
          classes={classes}
          use={use}
          bounds={bounds}
          places={own}
          width={width}
        />
      )}
    </Figure>
  );
});

function lineOf(index: LaneIndex, id: string) {
  const lane = index.byId.get(id);
  return lane && index.lineOf(lane);
}

function percent(share: number): string {
  return `${(share * 100).toFixed(1)} %`;
}

function numbersOf({ lanes }: Coverage, index: LaneIndex): Numbers {
  return {
    columns: ["lane", "from (m)", "to (m)", "egos", "all actors"],
    rows: lanes.flatMap((lane) =>
      piecesOf(lane, lengthOf(lineOf(index, lane.lane) ?? [])).map(({ from, to, egos, actors }) => [
        lane.lane,
        from,
        to,
        egos,
        actors,
      ]),
    ),
  };
}
