import type { Schemas } from "../../api/client";
import type { MarkLook } from "../../components/Mark";

type State = Schemas["CampaignState"];

const LOOKS: Readonly<Record<State, MarkLook>> = {
  queued: { sign: "○", tone: "quiet", text: "queued" },
  running: { sign: "▸", tone: "live", text: "running" },
  paused: { sign: "‖", tone: "lost", text: "paused" },
  finished: { sign: "✓", tone: "good", text: "finished" },
  failed: { sign: "⚠", tone: "lost", text: "failed" },
  cancelled: { sign: "–", tone: "quiet", text: "cancelled" },
  interrupted: { sign: "⚠", tone: "lost", text: "interrupted" },
};

export const STATES = Object.keys(LOOKS) as readonly State[];

const REQUESTS = { "": "", pause: ", will pause", cancel: ", will be cancelled" } as const;

/** Returns how the state of a campaign or of a study is shown, with the pending request. */
export function lookOfSearch(
  state: Schemas["CampaignState"] | Schemas["StudyState"],
  request: Schemas["CampaignRequest"],
): MarkLook {
  const look = LOOKS[state];
  return { ...look, text: look.text + REQUESTS[request] };
}

export type Action = "pause" | "resume" | "cancel";

/** Returns what can be asked of a campaign or a study in this state. */
export function actionsOf(
  state: Schemas["CampaignState"] | Schemas["StudyState"],
  request: Schemas["CampaignRequest"],
): readonly Action[] {
  if (state === "finished" || state === "cancelled") return [];
  if (state === "running" || state === "queued") {
    if (request === "cancel") return [];
    return request === "pause" ? ["cancel"] : ["pause", "cancel"];
  }
  return ["resume", "cancel"];
}

/** Returns the name without its place in the study, which other columns show, but for the repetition. */
export function shortName(name: string, cell: Schemas["StudyCell"] | null | undefined): string {
  if (!cell) return name;
  const { scenario, agent, method, repetition } = cell;
  const place = `, ${scenario}, ${agent}, ${method}, ${repetition}`;
  return name.endsWith(place) ? `${name.slice(0, -place.length)} · ${repetition}` : name;
}
