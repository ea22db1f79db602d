import { useMutation } from "@tanstack/react-query";
import { useNavigate } from "@tanstack/react-router";
import { type RefObject, useMemo, useRef, useState } from "react";
import { api, body, type Schemas } from "../../api/client";
import { fieldId } from "../../components/fields/Field";
import { isObject, type JsonObject, keysOf, valueAt } from "../../components/fields/pointers";
import type { Camera } from "../../roads/camera";
import { useScope } from "../../shell/session";
import { HANDED_OVER, HANDED_OVER_FROM } from "../compose/beginning";
import { extentOf, type Part } from "../networks/search";
import type { Chosen } from "./AuthorLayer";
import type { AuthorMapHandle } from "./AuthorMap";
import { boxOf, extentOfActors } from "./extents";
import type { KindPlace } from "./places";
import { planeOf, toDocument } from "./plane";
import {
  actorOf,
  listNameOf,
  noActorYet,
  withActor,
  withCopy,
  without,
  withPlaceMoved,
  withWaypoint,
} from "./scenario";
import { type ShownActor, shownActors } from "./shownActors";
import { withDrive, withWalk } from "./situations";
import type { Snapped } from "./snapping";
import { hasRoute, SELECT, type Tool } from "./tool";
import type { Draft } from "./useDraft";
import { useInspection } from "./useInspection";
import type { KnownModels } from "./useModels";

const NOTHING: Chosen = { actor: "", place: "" };

/** What is on the desk, and what can be done with it. */
export type Desk = ReturnType<typeof useDesk>;

export function useDesk(
  draft: Draft,
  geometry: Schemas["NetworkGeometry"],
  models: KnownModels,
  offset: readonly number[] | undefined,
  map: RefObject<AuthorMapHandle | null>,
) {
  const navigate = useNavigate();
  const { maySubmit } = useScope();
  const [chosen, setChosen] = useState<Chosen>(NOTHING);
  const [tool, setTool] = useState<Tool>(SELECT);
  const [side, setSide] = useState<"fields" | "text">("fields");
  const [asked, setAsked] = useState<{ readonly pointer: string }>();
  const [unreadable, setUnreadable] = useState("");
  /** The document while something is dragged; it is not yet in the history. */
  const [dragged, setDragged] = useState<JsonObject>();
  const camera = useRef<Camera>(undefined);
  const { scenario } = draft;
  const seen = dragged ?? scenario;
  const { frame } = scenario;
  const plane = useMemo(() => planeOf(frame, offset), [frame, offset]);
  const { inspection, of, error } = useInspection(seen);
  const actors = useMemo(
    () => shownActors(seen, plane, models.sizes, inspection),
    [seen, plane, models, inspection],
  );
  const write = (place: { x: number; y: number; yaw: number | undefined }) =>
    toDocument(plane, place.x, place.y, place.yaw);

  const choose = (next: Chosen) => {
    setChosen(next);
    if (next.actor) setSide("fields");
  };
  /** Takes a changed document, and chooses what is new in it. */
  const take = (made: readonly [JsonObject, string] | undefined) => {
    if (!made || made[0] === scenario) return;
    draft.change(made[0]);
    choose({ actor: made[1], place: "" });
  };
  const run = useMutation({
    mutationFn: async () =>
      body(
        await api.POST("/api/v1/jobs", {
          params: { query: { label: draft.name } },
          body: scenario as unknown as Schemas["ScenarioDocument"],
        }),
      ),
  });
  const isValid = of === scenario && inspection?.valid === true;
  const canRun = maySubmit && isValid && !run.isPending;
  const isWaypoint = keysOf(chosen.place)[2] === "route";

  return {
    draft,
    geometry,
    actors,
    chosen: isObject(valueAt(scenario, chosen.actor)) && chosen.actor ? chosen : NOTHING,
    tool,
    side,
    asked,
    unreadable,
    camera,
    inspection,
    /** Whether the service has seen the newest state. */
    isSeen: of === seen,
    error: run.error ?? error,
    run,
    canRun,
    mayVary: maySubmit && isValid,
    setSide,
    setUnreadable,
    choose,
    select: (place: string) => setChosen({ actor: chosen.actor, place }),
    use: (next: Tool) => {
      setTool(next);
      if (next.kind === "add") setChosen(NOTHING);
    },
    place: (at: Snapped) => {
      if (tool.kind === "extend") draft.change(withWaypoint(scenario, tool.actor, write(at)));
      if (tool.kind !== "add") return;
      const made = withActor(scenario, tool.list, [write(at)]);
      take(made);
      const [, actor] = made;
      setTool(hasRoute(tool.list) ? { kind: "extend", list: tool.list, actor } : SELECT);
    },
    move: (pointer: string, at: Snapped) =>
      setDragged(withPlaceMoved(scenario, pointer, write(at))),
    moved: (kept: boolean) => {
      if (kept && dragged) draft.change(dragged);
      setDragged(undefined);
    },
    nudge: (dx: number, dy: number) => {
      const actor = actors.find(({ pointer }) => pointer === chosen.actor);
      const place = actor?.places.find(({ pointer }) => pointer === chosen.place);
      const at = place ?? actor?.places[0];
      if (!at) return;
      const to = toDocument(plane, at.x + dx, at.y + dy);
      draft.change(withPlaceMoved(scenario, at.pointer, to), `move ${at.pointer}`);
    },
    remove: (pointer: string) => {
      draft.change(without(scenario, pointer));
      setTool(SELECT);
      setChosen(actorOf(pointer) === pointer ? NOTHING : { actor: actorOf(pointer), place: "" });
    },
    removeChosen() {
      const pointer = isWaypoint ? chosen.place : chosen.actor;
      if (pointer) this.remove(pointer);
    },
    extend: () => {
      const list = listNameOf(chosen.actor);
      if (list && hasRoute(list)) setTool({ kind: "extend", list, actor: chosen.actor });
    },
    copy: () => chosen.actor && take(withCopy(scenario, chosen.actor)),
    drive: (place: KindPlace) => take(withDrive(scenario, place, write)),
    walk: (place: KindPlace) => take(withWalk(scenario, place, write)),
    /** Ends what is going on, else chooses nothing. */
    leave: () => (tool.kind === "select" ? setChosen(NOTHING) : setTool(SELECT)),
    end: () => setTool(SELECT),
    toPart: (part: Part) => {
      const { lanes, box } = extentOf(geometry, part);
      map.current?.highlight(lanes, part.what === "junction" ? geometry.junctions[part.id] : []);
      if (box.every(Number.isFinite)) map.current?.fit(box);
    },
    toPlace: (place: KindPlace) => {
      map.current?.highlight(place.lanes);
      map.current?.fit(boxOf(place.line, 10));
    },
    /** The box of all that was opened, once the ways are known; undefined if it is empty. */
    extent: of === undefined ? undefined : extentOfActors(actors),
    fit: () => map.current?.fit(extentOfActors(actors)),
    /** Leads to a place of the document: on the map, and in the fields or the text. */
    go: (pointer: string) => {
      const missing = noActorYet(scenario, pointer);
      if (missing) {
        setChosen(NOTHING);
        setTool({ kind: "add", list: missing });
        return;
      }
      setAsked({ pointer });
      const shown = actors.find((one) => one.pointer === actorOf(pointer));
      const place = shown?.places.find((one) => `${pointer}/`.startsWith(`${one.pointer}/`));
      setChosen({ actor: actorOf(pointer), place: place?.pointer ?? "" });
      const at: Pick<ShownActor, "x" | "y"> | undefined = place ?? shown;
      if (at) map.current?.look(at.x, at.y);
      // The fields of what has been chosen are there with the next frame.
      if (side === "fields")
        requestAnimationFrame(() => {
          // What is in no field, and belongs to no actor, is in the text alone.
          if (!focusField(pointer) && !actorOf(pointer)) setSide("text");
        });
    },
    start: () => canRun && run.mutate(),
    vary: () => {
      const { name, origin } = draft;
      const about = origin && { label: name, run: origin.run };
      sessionStorage.setItem(HANDED_OVER, JSON.stringify(scenario));
      sessionStorage.setItem(HANDED_OVER_FROM, JSON.stringify(about ?? null));
      void navigate({ to: "/campaigns/new", search: { from: "author" } });
    },
  };
}

/** Brings the field of a place, or the nearest around it, into sight; false if there is none. */
function focusField(pointer: string): boolean {
  for (let rest = pointer; rest !== ""; rest = rest.slice(0, rest.lastIndexOf("/"))) {
    const field = document.getElementById(fieldId(rest));
    if (!field) continue;
    for (const part of ancestorsOf(field)) part.open = true;
    field.scrollIntoView({ block: "center" });
    field.focus();
    return true;
  }
  return false;
}

function ancestorsOf(element: HTMLElement): readonly HTMLDetailsElement[] {
  const found: HTMLDetailsElement[] = [];
  let part = element.closest("details");
  while (part) {
    found.push(part);
    part = part.parentElement?.closest("details") ?? null;
  }
  return found;
}
