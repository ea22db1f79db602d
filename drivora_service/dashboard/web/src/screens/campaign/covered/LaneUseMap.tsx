import { useNavigate } from "@tanstack/react-router";
import { type MouseEvent, useMemo, useState } from "react";
import type { Schemas } from "../../../api/client";
import { type CountClass, classOf } from "../../../components/charts/countClasses";
import { type Bounds, linePath, type Plan, planOf } from "../../../components/charts/placeMap";
import { count, fixed } from "../../../components/numbers";
import type { LaneIndex } from "../../../roads/laneIndex";
import { lengthOf, partOf } from "../../../roads/lines";
import { FailureMarks } from "./FailureMarks";
import type { FailurePlace } from "./failurePlaces";
import { LaneUseLegend, legendHeight } from "./LaneUseLegend";
import { type Piece, pieceAt, type Use } from "./laneUse";
import { drawingOf, laneNear } from "./roadDrawing";

type Lane = Schemas["LaneGeometry"];

/** On both sides together. */
const EDGE_PX = 4;

interface Pointed {
  readonly lane: Lane;
  readonly length: number;
  /** Undefined on a lane that was never used. */
  readonly piece: Piece | undefined;
}

export interface LaneUseMapProps {
  readonly network: string;
  readonly lanes: readonly Schemas["LaneCoverage"][];
  /** The drivable lanes of the network. */
  readonly index: LaneIndex;
  readonly classes: readonly CountClass[];
  readonly use: Use;
  readonly bounds: Bounds;
  readonly places: readonly FailurePlace[];
  readonly width: number;
}

/** The drivable lanes of a network in the colours of their use, with failures where they began. */
export function LaneUseMap(props: LaneUseMapProps) {
  const { network, lanes, index, classes, use, bounds, places, width } = props;
  const navigate = useNavigate();
  const [pointed, setPointed] = useState<Pointed>();
  const plan = useMemo(() => planOf(bounds, width), [bounds, width]);
  const counted = useMemo(() => new Map(lanes.map((lane) => [lane.lane, lane])), [lanes]);
  const drawn = useMemo(() => {
    const shadeOf = (count: number) => classOf(classes, count)?.shade;
    return drawingOf(index, counted, use, shadeOf, plan, width);
  }, [index, counted, use, classes, plan, width]);
  const pointedBy = (event: MouseEvent<SVGSVGElement>): Pointed | undefined => {
    const box = event.currentTarget.getBoundingClientRect();
    const place = laneNear(index, plan, event.clientX - box.left, event.clientY - box.top);
    if (!place) return undefined;
    const length = lengthOf(index.lineOf(place.lane));
    const found = counted.get(place.lane.id);
    return { lane: place.lane, length, piece: found && pieceAt(found, length, place.offset) };
  };
  const open = (event: MouseEvent<SVGSVGElement>) => {
    const mark = event.target instanceof Element && event.target.closest("[data-id]");
    const number = mark ? mark.getAttribute("data-id") : null;
    const lane = pointedBy(event)?.lane.id;
    if (number !== null)
      void navigate({ to: ".", search: { tab: "ancestry", number }, resetScroll: false });
    else if (lane !== undefined)
      void navigate({ to: "/networks/$name", params: { name: network }, search: { lane } });
  };
  return (
    <>
      {/* biome-ignore lint/a11y/useKeyWithClickEvents: the lists of failures and of lanes open them by keyboard */}
      <svg
        className="chart road-use"
        width={width}
        height={plan.height + legendHeight(classes, width)}
        role="img"
        aria-label={`Use of the lanes of ${network}, and places of ${places.length} failures`}
        data-pointed={pointed !== undefined}
        onPointerMove={(event) => setPointed(pointedBy(event))}
        onPointerLeave={() => setPointed(undefined)}
        onClick={open}
      >
        {/* A drawing of its own, which cuts off what is beside it. */}
        <svg width={width} height={plan.height} aria-hidden="true">
          {pointed && <Edge pointed={pointed} index={index} plan={plan} />}
          {drawn.map(({ look, thick, path }) => (
            <path
              key={`${look} ${thick}`}
              className={`lane ${look}`}
              strokeWidth={thick}
              d={path}
            />
          ))}
          <FailureMarks places={places} plan={plan} />
        </svg>
        <LaneUseLegend classes={classes} use={use} plan={plan} width={width} />
      </svg>
      <p className="pointed-at quiet">
        {pointed
          ? textOf(pointed)
          : "Point at a lane to read its counts; a click opens a lane, or a failure."}
      </p>
    </>
  );
}

/** The edges of the piece of a lane that is pointed at, or of the whole of an unused one. */
function Edge({
  pointed: { lane, length, piece },
  index,
  plan,
}: {
  readonly pointed: Pointed;
  readonly index: LaneIndex;
  readonly plan: Plan;
}) {
  const line = partOf(index.lineOf(lane), piece?.from ?? 0, piece?.to ?? length);
  return (
    <path
      className="lane pointed"
      data-passing
      strokeWidth={Math.max(lane.width * plan.scale, 2) + EDGE_PX}
      d={linePath(line, plan)}
    />
  );
}

function textOf({ lane, length, piece }: Pointed): string {
  if (!piece) return `Lane ${lane.id}, ${fixed(length, 0)} m long: never used`;
  const { from, to, egos, actors } = piece;
  return `Lane ${lane.id}, ${fixed(from, 0)} to ${fixed(to, 0)} of ${fixed(length, 0)} m: egos ${count(egos)}, all actors ${count(actors)}`;
}
