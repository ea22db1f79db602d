import { useSearch } from "@tanstack/react-router";
import { useMemo } from "react";
import { firstOf } from "../../../address";
import type { Schemas } from "../../../api/client";
import { Choice } from "../../../components/Choice";
import { classesOf } from "../../../components/charts/countClasses";
import { Loading, Refused } from "../../../components/States";
import { useGeometry } from "../../../roads/useGeometry";
import { AREAS, type Area, USES, type Use } from "./laneUse";
import { RoadFigure } from "./RoadFigure";
import { MOST_PLACES, useFailurePlaces } from "./useFailurePlaces";

type Campaign = Schemas["Campaign"];
type Coverage = Schemas["NetworkCoverage"];

const USE_TEXT: Readonly<Record<Use, string>> = { egos: "egos", actors: "all actors" };
const AREA_TEXT: Readonly<Record<Area, string>> = {
  used: "used roads",
  network: "whole network",
};

/** How often the roads of each network were used, with the failures where they began. */
export function Roads({
  campaign,
  networks,
}: {
  readonly campaign: Campaign;
  readonly networks: readonly Coverage[];
}) {
  const search = useSearch({ from: "/campaigns/$id" });
  const use = USES.find((name) => name === firstOf(search, "use")) ?? "egos";
  const area = AREAS.find((name) => name === firstOf(search, "area")) ?? "used";
  const found = useFailurePlaces(campaign);
  return (
    <section className="panel">
      <header>
        <h2>Roads</h2>
        <span className="choices">
          <Choice
            name="use"
            title="Used by"
            value={use}
            search={search}
            options={USES.map((value) => ({ value, text: USE_TEXT[value] }))}
          />
          <Choice
            name="area"
            title="Map"
            value={area}
            search={search}
            options={AREAS.map((value) => ({ value, text: AREA_TEXT[value] }))}
          />
        </span>
      </header>
      <div className="inside side-by-side-maps">
        {found.isPending ? (
          <Loading />
        ) : found.isError ? (
          <Refused error={found.error} onRepeat={() => void found.refetch()} />
        ) : (
          <>
            <Maps
              campaign={campaign.id}
              networks={networks}
              use={use}
              area={area}
              places={found.data.places}
            />
            {found.data.missing > 0 && (
              <p className="quiet">{found.data.missing} failures have no place.</p>
            )}
            {found.data.more && (
              <p className="quiet">Only the first {MOST_PLACES} failures are shown.</p>
            )}
          </>
        )}
      </div>
    </section>
  );
}

type Shown = Pick<Parameters<typeof RoadFigure>[0], "campaign" | "use" | "area" | "places">;

function Maps({ networks, ...shown }: Shown & { readonly networks: readonly Coverage[] }) {
  const { use } = shown;
  // The same colours on all maps.
  const classes = useMemo(
    () => classesOf(networks.flatMap(({ lanes }) => lanes.flatMap((lane) => lane[use]))),
    [networks, use],
  );
  return networks.map((coverage) => (
    <OneMap key={coverage.network} coverage={coverage} classes={classes} {...shown} />
  ));
}

function OneMap(props: Omit<Parameters<typeof RoadFigure>[0], "geometry">) {
  const { data, error, isPending, refetch } = useGeometry(props.coverage.network);
  if (isPending) return <Loading />;
  if (error) return <Refused error={error} onRepeat={() => void refetch()} />;
  return <RoadFigure {...props} geometry={data} />;
}
