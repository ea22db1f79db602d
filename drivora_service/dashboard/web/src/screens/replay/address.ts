import { firstOf, type Search, valuesOf } from "../../address";
import { type Camera, readCamera } from "../../roads/camera";
import type { Pace } from "./difference";
import { isPart, type Range } from "./timeScale";

/** What a link to a replay says. */
export interface ReplayState {
  readonly time: number;
  readonly follow: string;
  /** Id of the ego whose values are shown; "" is the first. */
  readonly ego: string;
  /** The stretch that the time line and the plots show; undefined is the whole run. */
  readonly stretch: Range | undefined;
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
  const stretch = readStretch(firstOf(search, "from"), firstOf(search, "to"));
  // A link to a stretch alone begins with it.
  const time = Number(firstOf(search, "t") || (stretch?.from ?? 0));
  const trails = firstOf(search, "trails");
  return {
    time: Number.isFinite(time) ? Math.max(time, 0) : 0,
    follow: firstOf(search, "follow"),
    ego: firstOf(search, "ego"),
    stretch,
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

/** Returns the words of an address for a stretch of a run; none for the whole of it. */
export function stretchWords(range: Range, end: number): Record<"from" | "to", string | undefined> {
  if (!isPart(range, end)) return { from: undefined, to: undefined };
  return { from: range.from.toFixed(2), to: range.to.toFixed(2) };
}

function readStretch(from: string, to: string): Range | undefined {
  if (from === "" || to === "") return undefined;
  const range = { from: Math.max(Number(from), 0), to: Number(to) };
  return Number.isFinite(range.to) && range.from < range.to ? range : undefined;
}

/** Seconds that a replay of a failure begins before it, so that it is seen to come. */
const LEAD_IN_S = 4;

/** Returns the search of a link that replays a run up to a moment, from the begin without one. */
export function replayUpTo(time: number | null | undefined): { readonly t?: string } {
  return time == null || time <= LEAD_IN_S ? {} : { t: (time - LEAD_IN_S).toFixed(2) };
}
