import { firstOf, type Search, valuesOf } from "../../address";
import { type Camera, readCamera } from "../../roads/camera";
import type { Pace } from "./difference";

/** What a link to a replay says. */
export interface ReplayState {
  readonly time: number;
  readonly follow: string;
  readonly camera: Camera | undefined;
  readonly trails: number;
  readonly routes: boolean;
  readonly hidden: readonly string[];
  /** Whether what the ego perceived is shown. */
  readonly perceived: boolean;
  /** A second run in step with this one. */
  readonly beside: string;
  readonly view: "over" | "side";
  readonly pace: Pace;
}

export const TRAILS = [0, 3, 10, 1e6] as const;
const USUAL_TRAILS = 3;

export function readState(search: Search): ReplayState {
  const time = Number(firstOf(search, "t"));
  const trails = firstOf(search, "trails");
  return {
    time: Number.isFinite(time) ? Math.max(time, 0) : 0,
    follow: firstOf(search, "follow"),
    camera: readCamera(firstOf(search, "camera")),
    trails: trails === "" ? USUAL_TRAILS : trails === "all" ? 1e6 : Number(trails) || 0,
    routes: firstOf(search, "routes") !== "no",
    perceived: firstOf(search, "perceived") === "yes",
    hidden: valuesOf(search, "hide"),
    beside: firstOf(search, "with"),
    view: firstOf(search, "view") === "side" ? "side" : "over",
    pace: firstOf(search, "pace") === "route" ? "route" : "time",
  };
}

/** Returns the word of an address for a length of trails. */
export function trailsText(seconds: number): string {
  if (seconds === USUAL_TRAILS) return "";
  return seconds >= 1e6 ? "all" : String(seconds);
}

/** Seconds that a replay of a failure begins before it, so that it is seen to come. */
const LEAD_IN_S = 4;

/** Returns the search of a link that replays a run up to a moment, from the begin without one. */
export function replayUpTo(time: number | null | undefined): { readonly t?: string } {
  return time == null || time <= LEAD_IN_S ? {} : { t: (time - LEAD_IN_S).toFixed(2) };
}
