import { useQuery } from "@tanstack/react-query";
import { useNavigate } from "@tanstack/react-router";
import { api, body, type Schemas } from "../../api/client";
import { Figure } from "../../components/charts/Figure";
import { type Bounds, boundsOf, planOf, touches } from "../../components/charts/placeMap";
import { Loading, Refused } from "../../components/States";
import { kindText } from "../failures/words";
import { MOST_PLACES, useFailurePlaces } from "./useFailurePlaces";

const AROUND_M = 30;
/** Room for what the figure shows beyond them, as its sides have another proportion. */
const BEYOND_M = 200;

interface Place {
  readonly failure: Schemas["Failure"];
  readonly x: number;
  readonly y: number;
}

/** Where the failures of a campaign began, on the roads around them. */
export function PlacesMap({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const navigate = useNavigate();
  const roads = useQuery({
    queryKey: ["network", campaign.town, "geometry"],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/networks/{name}/geometry", {
          params: { path: { name: campaign.town } },
        }),
      ),
  });
  const found = useFailurePlaces(campaign);
  if (roads.isPending || found.isPending) return <Loading />;
  if (roads.isError) return <Refused error={roads.error} />;
  if (found.isError) return <Refused error={found.error} />;
  const places = found.data.failures.flatMap((failure): readonly Place[] => {
    const [x, y] = failure.verdict.location ?? [];
    return x === undefined || y === undefined ? [] : [{ failure, x, y }];
  });
  const bounds = boundsOf(
    places.map(({ x, y }) => [x, y]),
    AROUND_M,
  );
  if (!bounds) return <p className="quiet">No failure with a place so far.</p>;
  const missing = found.data.failures.length - places.length;
  const [left, bottom, right, top] = bounds;
  const wide: Bounds = [left - BEYOND_M, bottom - BEYOND_M, right + BEYOND_M, top + BEYOND_M];
  const lanes = roads.data.lanes.filter((lane) => lane.drivable && touches(lane.shape, wide));
  return (
    <Figure
      level={2}
      title="Where failures began"
      note={
        <>
          Crosses: failures that count; triangles: others. A click opens the evaluation.
          {missing > 0 && ` ${missing} failures have no place.`}
          {found.data.more && ` Only the first ${MOST_PLACES} are shown.`}
        </>
      }
      file={`${campaign.id}-places`}
      numbers={{
        columns: ["evaluation", "kind", "x (m)", "y (m)", "at fault", "avoidable"],
        rows: places.map(({ failure: { evaluation, kind, verdict }, x, y }) => [
          evaluation,
          kindText(kind),
          x,
          y,
          verdict.at_fault === null || verdict.at_fault === undefined
            ? "not known"
            : String(verdict.at_fault),
          verdict.avoidable ?? "not measured",
        ]),
      }}
    >
      {(width) => {
        const { height, toX, toY } = planOf(bounds, width);
        const metre = toX(1) - toX(0);
        return (
          // biome-ignore lint/a11y/useKeyWithClickEvents: the list of failures opens them by keyboard
          <svg
            className="chart places"
            width={width}
            height={height}
            role="img"
            aria-label={`Places of ${places.length} failures on ${campaign.town}`}
            onClick={(event) => {
              const mark = event.target instanceof Element && event.target.closest("[data-id]");
              const number = mark ? mark.getAttribute("data-id") : null;
              if (number !== null)
                void navigate({ to: ".", search: { tab: "ancestry", number }, resetScroll: false });
            }}
          >
            {lanes.map((lane) => (
              <path
                key={lane.id}
                className="lane"
                strokeWidth={Math.max(lane.width * metre, 1)}
                d={`M${lane.shape
                  .map(([x = 0, y = 0]) => `${toX(x).toFixed(1)},${toY(y).toFixed(1)}`)
                  .join("L")}`}
              />
            ))}
            {places.map(({ failure, x, y }) => {
              const counts =
                failure.verdict.at_fault === true && failure.verdict.avoidable === "yes";
              return (
                <path
                  key={`${failure.evaluation} ${failure.place}`}
                  data-id={failure.evaluation}
                  className={`point ${counts ? "bad" : "lost"}`}
                  d={counts ? "M-3.6,-3.6L3.6,3.6M-3.6,3.6L3.6,-3.6" : "M0,-4L4,3H-4Z"}
                  transform={`translate(${toX(x).toFixed(1)},${toY(y).toFixed(1)})`}
                >
                  <title>{`evaluation ${failure.evaluation}: ${failure.verdict.message}`}</title>
                </path>
              );
            })}
          </svg>
        );
      }}
    </Figure>
  );
}
