import { useNavigate } from "@tanstack/react-router";
import { useEffect, useMemo, useRef, useState } from "react";
import type { Schemas } from "../../api/client";
import { type Camera, cameraText, readCamera } from "../../roads/camera";
import { Highlight } from "../../roads/highlight";
import { LaneIndex, type LanePlace } from "../../roads/laneIndex";
import { type DrawnMap, RoadMap } from "../../roads/RoadMap";
import { useKeys } from "../../shell/keys";
import { LaneFacts } from "./LaneFacts";
import { PartSearch } from "./PartSearch";
import { Programme } from "./Programme";
import { extentOf, type Part } from "./search";

const SETTLED_MS = 400;

interface Clicked {
  readonly place: LanePlace;
  readonly x: number;
  readonly y: number;
}

interface Drawn extends DrawnMap {
  readonly hover: Highlight;
  readonly chosen: Highlight;
}

/** A network's map with its search, what is known of a lane, and the programmes of its lights. */
export function NetworkMap({
  geometry,
  part,
  camera,
}: {
  readonly geometry: Schemas["NetworkGeometry"];
  readonly part: Part | undefined;
  readonly camera: string;
}) {
  const navigate = useNavigate();
  const index = useMemo(() => new LaneIndex(geometry.lanes), [geometry]);
  const [map, setMap] = useState<Drawn>();
  const [pointed, setPointed] = useState<LanePlace>();
  const [clicked, setClicked] = useState<Clicked>();
  const first = useRef(readCamera(camera));
  /** Lane that the next address has because of a click. */
  const clickedLane = useRef<string>(undefined);
  const settled = useRef<ReturnType<typeof setTimeout>>(undefined);

  const go = (to: Part) =>
    void navigate({ to: ".", search: { [to.what]: to.id }, resetScroll: false });

  const onMap = (made: DrawnMap) => {
    const hover = new Highlight(index, made.palette.accent, 0.2);
    const chosen = new Highlight(index, made.palette.accent, 0.35);
    made.stage.world.addChild(hover, chosen);
    const draw = (changed: boolean) => changed && made.stage.draw();
    made.stage.onHover = (x, y) => {
      const place = index.at(x, y);
      draw(hover.show(place ? [place.lane.id] : []));
      setPointed(place);
    };
    made.stage.onLeave = () => {
      draw(hover.show([]));
      setPointed(undefined);
    };
    made.stage.onClick = (x, y) => {
      const place = index.at(x, y);
      setClicked(place && { place, x, y });
      clickedLane.current = place?.lane.id;
      if (place) go({ what: "lane", id: place.lane.id });
    };
    setMap({ ...made, hover, chosen });
    return () => setMap(undefined);
  };

  const what = part?.what;
  const id = part?.id;
  useEffect(() => {
    if (!map) return;
    if (!what || !id) {
      first.current = undefined;
      if (map.chosen.show([])) map.stage.draw();
      return;
    }
    const { lanes, box } = extentOf(geometry, { what, id });
    map.chosen.show(lanes, what === "junction" ? geometry.junctions[id] : []);
    // A lane that was clicked is in sight already.
    const byClick = what === "lane" && clickedLane.current === id;
    clickedLane.current = undefined;
    if (first.current) first.current = undefined;
    else if (box.every(Number.isFinite) && !byClick) map.stage.fit(box, true, 12);
    map.stage.draw();
  }, [map, geometry, what, id]);

  const keep = (now: Camera, byHand: boolean) => {
    if (!byHand) return;
    clearTimeout(settled.current);
    settled.current = setTimeout(() => {
      const search = (before: object) => ({ ...before, camera: cameraText(now) });
      void navigate({ to: ".", search, replace: true, resetScroll: false });
    }, SETTLED_MS);
  };
  useEffect(() => () => clearTimeout(settled.current), []);

  useKeys([
    {
      keys: "f",
      does: "show the whole network",
      run: () => map?.stage.fit(geometry.bounds as [number, number, number, number]),
    },
    { keys: "+", does: "nearer", run: () => map?.stage.zoom(1.4) },
    { keys: "-", does: "farther", run: () => map?.stage.zoom(1 / 1.4) },
  ]);

  const lane = clicked && what === "lane" && clicked.place.lane.id === id ? clicked : undefined;
  const found = what === "lane" && id && !lane ? index.byId.get(id) : undefined;
  const shown = lane ?? (found && middleOf(index, found.id));
  const light = geometry.traffic_lights.find((one) => what === "traffic light" && one.id === id);
  return (
    <div className="network">
      <RoadMap
        geometry={geometry}
        label={`Map of ${geometry.name}`}
        onMap={onMap}
        camera={first.current}
        onCamera={keep}
      >
        <div className="over top-left" aria-live="off" hidden={!pointed}>
          <code>{pointed?.lane.id}</code> {pointed && `${pointed.offset.toFixed(1)} m`}
        </div>
        <div className="buttons">
          <button type="button" onClick={() => map?.stage.zoom(1.4)} aria-label="Nearer">
            +
          </button>
          <button type="button" onClick={() => map?.stage.zoom(1 / 1.4)} aria-label="Farther">
            −
          </button>
          <button
            type="button"
            onClick={() => map?.stage.fit(geometry.bounds as [number, number, number, number])}
          >
            Fit
          </button>
        </div>
      </RoadMap>
      <div className="beside">
        <PartSearch geometry={geometry} chosen={part} onChoose={go} />
        {shown && (
          <LaneFacts
            {...shown}
            network={geometry.name}
            light={
              geometry.stop_lines.find((line) => line.lane === shown.place.lane.id)?.light ?? ""
            }
          />
        )}
        {what === "junction" && id && (
          <section className="panel" aria-label="Junction">
            <header>
              <h2>
                <code>{id}</code>
              </h2>
            </header>
            <p className="inside">
              Junction of type {geometry.junction_types[id]?.replaceAll("_", " ")}
            </p>
          </section>
        )}
        {light && (
          <section className="panel" aria-label="Traffic light">
            <header>
              <h2>
                <code>{light.id}</code>
              </h2>
            </header>
            <div className="inside">
              <Programme light={light} />
            </div>
          </section>
        )}
        <LightList geometry={geometry} chosen={light?.id} onChoose={go} />
      </div>
    </div>
  );
}

function middleOf(index: LaneIndex, id: string): Clicked | undefined {
  const lane = index.byId.get(id);
  const [x, y] = lane?.shape[0] ?? [];
  if (!lane || x === undefined || y === undefined) return undefined;
  return { place: { lane, offset: 0, lateral: 0 }, x, y };
}

function LightList({
  geometry,
  chosen,
  onChoose,
}: {
  readonly geometry: Schemas["NetworkGeometry"];
  readonly chosen: string | undefined;
  readonly onChoose: (part: Part) => void;
}) {
  if (geometry.traffic_lights.length === 0) return null;
  return (
    <section className="panel" aria-label="Traffic lights">
      <header>
        <h2>Traffic lights</h2>
      </header>
      <ul className="found inside">
        {geometry.traffic_lights.map((light) => (
          <li key={light.id}>
            <button
              type="button"
              aria-pressed={light.id === chosen}
              onClick={() => onChoose({ what: "traffic light", id: light.id })}
            >
              <code>{light.id}</code>
              <span className="quiet">{light.phases.length} phases</span>
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}
