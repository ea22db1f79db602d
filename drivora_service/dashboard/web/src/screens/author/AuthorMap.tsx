import {
  type ReactNode,
  type Ref,
  useEffect,
  useImperativeHandle,
  useMemo,
  useRef,
  useState,
} from "react";
import type { Schemas } from "../../api/client";
import type { Box, Camera } from "../../roads/camera";
import { Highlight } from "../../roads/highlight";
import { LaneIndex } from "../../roads/laneIndex";
import type { Grip } from "../../roads/MapStage";
import { type DrawnMap, RoadMap } from "../../roads/RoadMap";
import { AuthorLayer, type Chosen } from "./AuthorLayer";
import { ControlLayer } from "./ControlLayer";
import { listNameOf } from "./scenario";
import { actorNear, type ShownActor } from "./shownActors";
import { type Snapped, snapped } from "./snapping";
import type { Tool } from "./tool";

const NEAR_PX = 8;
const HANDLE_NEAR_PX = 12;

/** What other parts of the screen may ask of the map. */
export interface AuthorMapHandle {
  readonly look: (x: number, y: number, scale?: number) => void;
  /** Returns whether there is a map yet. */
  readonly fit: (box?: Box) => boolean;
  readonly zoom: (factor: number) => void;
  readonly camera: () => Camera | undefined;
  /** The place in the middle of the map. */
  readonly middle: (tool: Tool) => Snapped | undefined;
  readonly highlight: (lanes: readonly string[], outline?: readonly (readonly number[])[]) => void;
}

interface Drawn extends DrawnMap {
  readonly layer: AuthorLayer;
  readonly found: Highlight;
}

/** The map on which a scenario is written. */
export function AuthorMap({
  geometry,
  actors,
  chosen,
  tool,
  camera,
  onChoose,
  onPlace,
  onMove,
  onMoved,
  onCamera,
  children,
  ref,
}: {
  readonly geometry: Schemas["NetworkGeometry"];
  readonly actors: readonly ShownActor[];
  readonly chosen: Chosen;
  readonly tool: Tool;
  readonly camera: Camera | undefined;
  readonly onChoose: (chosen: Chosen) => void;
  /** A place was clicked with a tool that adds something. */
  readonly onPlace: (place: Snapped) => void;
  /** A place of the document is dragged. */
  readonly onMove: (pointer: string, place: Snapped) => void;
  /** It was dropped, or dragging was given up. */
  readonly onMoved: (kept: boolean) => void;
  readonly onCamera: (camera: Camera, byHand: boolean) => void;
  readonly children?: ReactNode;
  readonly ref: Ref<AuthorMapHandle>;
}) {
  const index = useMemo(() => new LaneIndex(geometry.lanes), [geometry]);
  const [map, setMap] = useState<Drawn>();
  const [pointed, setPointed] = useState("");
  const now = useRef({ actors, chosen, tool, onChoose, onPlace, onMove, onMoved });
  now.current = { actors, chosen, tool, onChoose, onPlace, onMove, onMoved };

  const onMap = (made: DrawnMap) => {
    const { stage, palette } = made;
    const found = new Highlight(index, palette.accent, 0.3);
    const controls = new ControlLayer(geometry, palette);
    stage.world.addChild(controls, found);
    const layer = new AuthorLayer(made);
    stage.beforeDraw = (view, size) => {
      controls.show(view.scale);
      layer.show(view, size);
    };
    const placeAt = (x: number, y: number, event: PointerEvent) => {
      const list = listOfTool(now.current.tool);
      return list && snapped(index, list, x, y, { free: event.altKey });
    };
    stage.onHover = (x, y, event) => {
      const place = placeAt(x, y, event);
      if (place) {
        layer.point(ghostOf(now.current.tool, now.current.actors, place));
        stage.canvas.style.cursor = "crosshair";
        setPointed(place.lane);
      } else {
        const near = actorNear(now.current.actors, x, y, reach(NEAR_PX));
        stage.canvas.style.cursor = near || handleNear(x, y) ? "grab" : "";
        setPointed(near?.id ?? controls.nameAt(x, y));
      }
      stage.draw();
    };
    stage.onLeave = () => {
      layer.point(undefined);
      setPointed("");
      stage.draw();
    };
    stage.onClick = (x, y, event) => {
      const place = placeAt(x, y, event);
      if (place) {
        layer.point(undefined);
        now.current.onPlace(place);
        return;
      }
      const handle = handleNear(x, y);
      const near = actorNear(now.current.actors, x, y, reach(NEAR_PX));
      const actor = handle ? now.current.chosen.actor : (near?.pointer ?? "");
      now.current.onChoose({ actor, place: handle?.pointer ?? "" });
    };
    stage.onGrab = (x, y) => {
      if (listOfTool(now.current.tool)) return undefined;
      const handle = handleNear(x, y);
      if (handle)
        return gripOf(handle.pointer, now.current.chosen.actor, x - handle.x, y - handle.y);
      const near = actorNear(now.current.actors, x, y, reach(NEAR_PX));
      const [first] = near?.places ?? [];
      return near && first && gripOf(first.pointer, near.pointer, x - first.x, y - first.y);
    };
    const reach = (px: number) => px / stage.camera.scale;
    const handleNear = (x: number, y: number) => {
      const { actors: all, chosen: what } = now.current;
      const places = all.find(({ pointer }) => pointer === what.actor)?.places ?? [];
      return places.find((place) => Math.hypot(place.x - x, place.y - y) < reach(HANDLE_NEAR_PX));
    };
    const gripOf = (pointer: string, actor: string, dx: number, dy: number): Grip => {
      const list = listNameOf(pointer) ?? "npc_walkers";
      return {
        move: (x, y, event) => {
          if (now.current.chosen.actor !== actor || now.current.chosen.place !== pointer)
            now.current.onChoose({ actor, place: pointer });
          stage.canvas.style.cursor = "grabbing";
          const free = event.altKey;
          now.current.onMove(pointer, snapped(index, list, x - dx, y - dy, { free }));
        },
        drop: () => now.current.onMoved(true),
        cancel: () => now.current.onMoved(false),
      };
    };
    setMap({ ...made, layer, found });
    return () => setMap(undefined);
  };

  useEffect(() => {
    map?.layer.set(actors, chosen);
    map?.stage.draw();
  }, [map, actors, chosen]);
  useEffect(() => {
    if (!map) return;
    map.layer.point(undefined);
    map.stage.canvas.style.cursor = listOfTool(tool) ? "crosshair" : "";
    map.stage.draw();
  }, [map, tool]);

  useImperativeHandle(
    ref,
    () => ({
      look: (x, y, scale) =>
        map?.stage.look({ x, y, scale: scale ?? Math.max(map.stage.camera.scale, 5) }),
      fit: (box) => {
        map?.stage.fit(box ?? (geometry.bounds as [number, number, number, number]), true, 12);
        return map !== undefined;
      },
      zoom: (factor) => map?.stage.zoom(factor),
      camera: () => map?.stage.camera,
      middle: (what) => {
        const list = listOfTool(what);
        if (!map || !list) return undefined;
        return snapped(index, list, map.stage.camera.x, map.stage.camera.y);
      },
      highlight: (lanes, outline = []) => {
        map?.found.show(lanes, outline);
        map?.stage.draw();
      },
    }),
    [map, geometry, index],
  );

  return (
    <RoadMap
      geometry={geometry}
      label={`Map of ${geometry.name}`}
      onMap={onMap}
      camera={camera}
      onCamera={onCamera}
    >
      {pointed && (
        <div className="over top-left" aria-live="off">
          <code>{pointed}</code>
        </div>
      )}
      {children}
    </RoadMap>
  );
}

function listOfTool(tool: Tool) {
  return tool.kind === "select" ? undefined : tool.list;
}

function ghostOf(tool: Tool, actors: readonly ShownActor[], { x, y, yaw = 0 }: Snapped) {
  if (tool.kind === "select") return undefined;
  const last =
    tool.kind === "extend"
      ? actors.find(({ pointer }) => pointer === tool.actor)?.places.at(-1)
      : undefined;
  return { list: tool.list, x, y, yaw, from: last && ([last.x, last.y] as const) };
}
