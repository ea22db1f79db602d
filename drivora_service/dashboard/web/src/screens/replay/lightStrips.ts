import type { Schemas } from "../../api/client";

type Colour = "red" | "yellow" | "green" | "off";
const COLOURS: Readonly<Record<string, Colour>> = { red: "red", yellow: "yellow", green: "green" };

interface Strip {
  readonly first: number;
  readonly last: number;
  readonly colour: Colour;
  readonly title: string;
}

/** What the signals ahead of an ego showed while it came near, for its row of the time line. */
export function stripsOf(
  timeline: Schemas["Timeline"] | undefined,
  ego: number,
  stepLength: number,
): readonly Strip[] {
  const found: Strip[] = [];
  for (const light of timeline?.lights ?? [])
    for (const approach of light.approaches) {
      if (approach.ego !== ego) continue;
      for (const phase of light.phases) {
        const first = Math.max(phase.first, approach.first);
        const last = Math.min(phase.last, approach.last);
        if (last < first) continue;
        const colour = COLOURS[phase.light] ?? "off";
        const at = (step: number) => (step * stepLength).toFixed(2);
        found.push({
          first,
          last: last + 1,
          colour,
          title: `Signal ${light.link} of ${light.id}: ${colour} from ${at(phase.first)} s to ${at(phase.last + 1)} s`,
        });
      }
    }
  return found;
}
