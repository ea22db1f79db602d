import { isObject, type JsonObject } from "../../components/fields/pointers";
import { useRemembered } from "../../lists/remembered";
import type { Written } from "./history";
import { type Origin, originWords, readOrigin } from "./origin";
import { actorsOf, townOf } from "./scenario";

const KEY = "drivora:drafts";
const MOST = 12;

/** A scenario that was written before another was opened. */
export interface Earlier {
  /** When it was left, ISO 8601. */
  readonly at: string;
  readonly scenario: JsonObject;
  /** What it was opened from; undefined of one that began with a network. */
  readonly origin?: Origin | undefined;
  readonly isEdited?: boolean;
}

/** Keeps a scenario that another takes the place of, if there is anything in it. */
export function keepEarlier({ document: scenario, origin, isEdited }: Written): void {
  if (actorsOf(scenario).length === 0) return;
  const text = JSON.stringify(scenario);
  const others = stored().filter((one) => JSON.stringify(one.scenario) !== text);
  const all = [{ at: new Date().toISOString(), scenario, origin, isEdited }, ...others].slice(
    0,
    MOST,
  );
  try {
    localStorage.setItem(KEY, JSON.stringify(all));
  } catch {
    // Too much for the browser: the newest alone.
    localStorage.setItem(KEY, JSON.stringify(all.slice(0, 1)));
  }
}

/** Returns the scenarios that were written before, the newest first. */
export function useEarlier(): readonly Earlier[] {
  const [earlier] = useRemembered(KEY, read);
  return earlier;
}

/** Returns the words for one: what it was opened from or its network, its actors, when it was left. */
export function wordsOf({ at, scenario, origin, isEdited = false }: Earlier): string {
  const actors = actorsOf(scenario).length;
  const when = at.slice(0, 16).replace("T", " ");
  const name = origin ? originWords(origin, isEdited) : townOf(scenario);
  return `${name}, ${actors} ${actors === 1 ? "actor" : "actors"}, ${when}`;
}

function stored(): readonly Earlier[] {
  try {
    return read(JSON.parse(localStorage.getItem(KEY) ?? "[]"));
  } catch {
    return [];
  }
}

function read(found: unknown): readonly Earlier[] {
  if (!Array.isArray(found)) return [];
  return found.flatMap((one: unknown) =>
    isObject(one) && typeof one.at === "string" && isObject(one.scenario)
      ? [
          {
            at: one.at,
            scenario: one.scenario,
            origin: readOrigin(one.origin),
            isEdited: one.isEdited === true,
          },
        ]
      : [],
  );
}
