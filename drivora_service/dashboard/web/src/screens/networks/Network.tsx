import { useParams, useSearch } from "@tanstack/react-router";
import { firstOf } from "../../address";
import { count, fixed } from "../../components/numbers";
import { Loading, Refused } from "../../components/States";
import { useGeometry } from "../../roads/useGeometry";
import { useTitle } from "../../shell/useTitle";
import { NetworkMap } from "./NetworkMap";
import type { Part } from "./search";

const PARTS: readonly Part["what"][] = ["lane", "edge", "junction", "street", "traffic light"];

export function Network() {
  const { name } = useParams({ from: "/networks/$name" });
  const search = useSearch({ from: "/networks/$name" });
  useTitle(name);
  const { data: geometry, error, isPending, refetch } = useGeometry(name);
  if (isPending) return <Loading />;
  if (error) return <Refused error={error} onRepeat={() => void refetch()} />;
  const what = PARTS.find((part) => firstOf(search, part) !== "");
  const part = what && { what, id: firstOf(search, what) };
  const roads = geometry.lanes.filter((lane) => lane.kind === "road");
  const fastest = Math.max(0, ...roads.map((lane) => lane.speed_limit));
  return (
    <>
      <div className="head">
        <h1>{name}</h1>
        <p className="answer">
          {count(geometry.lanes.length)} lanes, {count(roads.length)} of them outside junctions,{" "}
          {count(Object.keys(geometry.junctions).length)} junctions,{" "}
          {count(geometry.traffic_lights.length)} traffic lights, {count(geometry.crossings.length)}{" "}
          crossings; up to {fixed(fastest * 3.6, 0)} km/h
        </p>
      </div>
      <NetworkMap geometry={geometry} part={part} camera={firstOf(search, "camera")} />
    </>
  );
}
