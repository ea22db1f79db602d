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
import { type Camera, withSight } from "../../roads/camera";
import type { MapStage } from "../../roads/MapStage";
import { type DrawnMap, RoadMap } from "../../roads/RoadMap";
import { Ruler } from "../../roads/Ruler";
import type { ReplayState } from "./address";
import type { Moment } from "./follower";
import type { PerceivedActors } from "./perception";
import type { AgentTold } from "./plans";
import { ReplayScene } from "./ReplayScene";
import type { Recording } from "./recording";
import { egoInSight, egoOfMark } from "./sight";

const NEAR_PX = 10;
/** Pixels a metre at least when an actor begins to be followed. */
export const FOLLOW_SCALE = 7;
/** Of the ego that is kept in sight, where it will be after these seconds as well. */
const FORESIGHT_S = 2;

/** What other parts of the screen may ask of the map. */
export interface MapHandle {
  look: (camera: Camera) => void;
  stage: () => MapStage | undefined;
  fit: () => void;
  zoom: (factor: number) => void;
}

interface Shown extends DrawnMap {
  readonly scene: ReplayScene;
  readonly ruler: Ruler;
}

/** The map of a run at the time of its clock. */
export function ReplayMap({
  geometry,
  recording,
  loaded,
  clock,
  over,
  label = "The run on the map",
  caption,
  violations,
  state,
  focus = 0,
  perceived,
  told,
  measuring,
  onCamera,
  onFollow,
  ref,
}: {
  readonly geometry: Schemas["NetworkGeometry"];
  readonly recording: Recording;
  /** Steps that are there. */
  readonly loaded: number;
  readonly clock: Moment;
  /** A second run over this one, as outlines. */
  readonly over?: { readonly recording: Recording; readonly moment: Moment } | undefined;
  readonly label?: string;
  /** Which run it is, where there are two. */
  readonly caption?: ReactNode;
  readonly violations: readonly Schemas["ViolationMark"][];
  readonly state: ReplayState;
  /** Row of the ego that is kept in sight until the reader moves the map. */
  readonly focus?: number;
  readonly perceived: PerceivedActors | undefined;
  readonly told: AgentTold | undefined;
  readonly measuring: boolean;
  readonly onCamera: (camera: Camera, byHand: boolean) => void;
  readonly onFollow: (id: string) => void;
  readonly ref: Ref<MapHandle>;
}) {
  const [shown, setShown] = useState<Shown>();
  const [pointed, setPointed] = useState("");
  const second = useRef<{ scene: ReplayScene; moment: Moment }>(undefined);
  const handlers = useRef({ onCamera, onFollow });
  handlers.current = { onCamera, onFollow };
  const follow = useRef(state.follow);
  follow.current = state.follow;
  const sight = useRef({ focus, sighted: focus, violations });
  if (sight.current.focus !== focus) sight.current = { focus, sighted: focus, violations };
  sight.current.violations = violations;
  // The camera of the address, and one that the reader moved, is never changed.
  const chosen = useRef(state.camera !== undefined);
  const isMeasuring = useRef(measuring);
  isMeasuring.current = measuring;

  const onMap = (map: DrawnMap) => {
    const { stage, signals } = map;
    const scene = new ReplayScene(map, recording);
    const ruler = new Ruler(map.palette);
    stage.screen.addChild(ruler);
    stage.beforeDraw = (camera, size) => {
      for (const light of recording.lights.keys())
        signals.set(light, recording.stateOf(light, clock.step));
      scene.show(clock.time, camera, size);
      second.current?.scene.show(second.current.moment.time, camera, size);
      ruler.show(camera, size);
    };
    stage.onHover = (x, y) => {
      if (isMeasuring.current) {
        ruler.point(x, y);
        stage.draw();
        return;
      }
      const row = scene.actorAt(x, y, NEAR_PX / stage.camera.scale);
      stage.canvas.style.cursor = row === undefined ? "" : "pointer";
      setPointed(row === undefined ? "" : (recording.actors[row]?.id ?? ""));
    };
    stage.onLeave = () => setPointed("");
    stage.onClick = (x, y) => {
      if (isMeasuring.current) {
        ruler.click(x, y);
        stage.draw();
        return;
      }
      const row = scene.actorAt(x, y, NEAR_PX / stage.camera.scale);
      const id = row === undefined ? undefined : recording.actors[row]?.id;
      if (id) handlers.current.onFollow(id === follow.current ? "" : id);
    };
    stage.onDrag = () => {
      if (!follow.current) return;
      // At once: a replay that plays would draw the map back to the actor.
      follow.current = "";
      handlers.current.onFollow("");
    };
    let first = true;
    stage.afterDraw = () => {
      // For measurements: when the first actors could be seen.
      if (first && recording.loaded > 0) performance.mark("replay: first frame");
      first = false;
    };
    const moved = () => {
      const row = recording.actors.find(({ id }) => id === follow.current)?.row;
      const place = row === undefined ? undefined : scene.placeOf(row, clock.time);
      if (place) stage.look({ ...stage.camera, x: place[0], y: place[1] });
      else keepInSight();
    };
    const keepInSight = () => {
      if (chosen.current) return stage.draw();
      const now = sight.current;
      // A reader who goes to a violation sees its ego; one who watches another is not drawn away.
      if (!clock.playing)
        now.sighted = egoOfMark(now.violations, recording.actors, clock.step) ?? now.sighted;
      const row = egoInSight(recording, now.sighted, clock.step);
      const places = [FORESIGHT_S, 0].flatMap((ahead) => {
        const place = scene.placeOf(row, clock.time + ahead);
        return place ? [place] : [];
      });
      const next = withSight(stage.camera, stage.size, places);
      if (next === stage.camera) stage.draw();
      else stage.look(next);
    };
    const stop = clock.listen(moved);
    setShown({ ...map, scene, ruler });
    return () => {
      stop();
      setShown(undefined);
    };
  };

  const hidden = useMemo(
    () =>
      new Set(recording.actors.filter(({ id }) => state.hidden.includes(id)).map(({ row }) => row)),
    [recording, state.hidden],
  );
  const followed = recording.actors.find(({ id }) => id === state.follow)?.row;
  const { trails, routes } = state;
  // biome-ignore lint/correctness/useExhaustiveDependencies: more steps are drawn when they come
  useEffect(() => {
    shown?.scene.set({ trails, routes, hidden, followed });
    shown?.stage.draw();
  }, [shown, trails, routes, hidden, followed, loaded]);
  // The actor whose scale stands: a link restores that of its camera.
  const scaled = useRef(state.camera ? followed : undefined);
  useEffect(() => {
    if (!shown) return;
    shown.stage.holdsMiddle = followed !== undefined;
    const before = scaled.current;
    scaled.current = followed;
    if (followed === undefined) return;
    const place = shown.scene.placeOf(followed, clock.time);
    if (!place) return;
    const { camera } = shown.stage;
    const scale = followed === before ? camera.scale : Math.max(camera.scale, FOLLOW_SCALE);
    shown.stage.look({ x: place[0], y: place[1], scale });
  }, [shown, followed, clock]);
  useEffect(() => {
    shown?.scene.mark(violations);
    shown?.stage.draw();
  }, [shown, violations]);

  useEffect(() => {
    shown?.scene.plan(told);
    shown?.stage.draw();
  }, [shown, told]);
  useEffect(() => {
    shown?.scene.perceive(perceived);
    shown?.stage.draw();
  }, [shown, perceived]);
  useEffect(() => {
    if (!shown) return;
    shown.stage.canvas.style.cursor = measuring ? "crosshair" : "";
    if (!measuring) shown.ruler.clear();
    shown.stage.draw();
  }, [shown, measuring]);

  useEffect(() => {
    if (!shown || !over) return;
    const scene = new ReplayScene(shown, over.recording, "outline");
    scene.set({ trails, routes: false, hidden: new Set(), followed: undefined });
    second.current = { scene, moment: over.moment };
    shown.stage.draw();
    return () => {
      second.current = undefined;
      // The stage destroys what it holds when it goes.
      if (!shown.stage.isGone) scene.destroy();
      shown.stage.draw();
    };
  }, [shown, over, trails]);

  const fitted = useRef(false);
  const whole = loaded >= recording.steps;
  const begun = loaded > 0;
  useEffect(() => {
    if (followed !== undefined) chosen.current = true;
    if (!shown || !begun || chosen.current || fitted.current) return;
    const { stage, scene } = shown;
    stage.fit(scene.opening(stage.size, clock.time, sight.current.sighted), false);
    if (whole) fitted.current = true;
  }, [shown, begun, whole, followed, clock]);

  useImperativeHandle(
    ref,
    () => ({
      fit: () => {
        if (state.follow) handlers.current.onFollow("");
        shown?.stage.fit(shown.scene.whole());
      },
      look: (camera) => {
        chosen.current = true;
        shown?.stage.look(camera);
      },
      stage: () => shown?.stage,
      zoom: (factor) => shown?.stage.zoom(factor),
    }),
    [shown, state.follow],
  );

  return (
    <RoadMap
      geometry={geometry}
      label={label}
      onMap={onMap}
      camera={state.camera}
      onCamera={(camera, byHand) => {
        if (byHand) chosen.current = true;
        handlers.current.onCamera(camera, byHand);
      }}
    >
      {caption && <div className="over top-right caption">{caption}</div>}
      {pointed && <div className="over top-left">{pointed}</div>}
    </RoadMap>
  );
}
