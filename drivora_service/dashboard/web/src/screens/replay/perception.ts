import type { Schemas } from "../../api/client";
import type { ArrowTable } from "./arrowTable";

type Head = Omit<Schemas["Perception"], "first" | "present" | "counts">;

/** Why an actor is not among those that the ego perceived, in words. */
const WORDS: Readonly<Record<string, string>> = {
  absent: "not yet there",
  perceived: "perceived",
  other_level: "on another level",
  out_of_range: "out of range",
  dropped: "missed by chance",
  hidden: "hidden",
};

/** What an ego perceived: a value of an actor at a step is at `step × actors + row`. */
export class PerceivedActors {
  readonly head: Head;
  /** Index in the names of sights, 255 where nothing is told. */
  readonly sight: Uint8Array;
  readonly x: Float32Array;
  readonly y: Float32Array;
  readonly yaw: Float32Array;
  private readonly seen: number;

  constructor(
    { head, columns, rows }: ArrowTable<Head>,
    readonly steps: number,
    readonly actors: number,
  ) {
    this.head = head;
    this.seen = head.sights.indexOf("perceived");
    this.sight = new Uint8Array(steps * actors).fill(255);
    this.x = new Float32Array(steps * actors).fill(Number.NaN);
    this.y = new Float32Array(steps * actors).fill(Number.NaN);
    this.yaw = new Float32Array(steps * actors).fill(Number.NaN);
    const column = (name: string) => columns.get(name) ?? new Float64Array(rows);
    const [step, actor, sight] = [column("step"), column("actor"), column("sight")];
    const [x, y, yaw] = [column("x"), column("y"), column("yaw")];
    for (let k = 0; k < rows; k++) {
      const cell = (step[k] as number) * actors + (actor[k] as number);
      this.sight[cell] = sight[k] as number;
      this.x[cell] = x[k] as number;
      this.y[cell] = y[k] as number;
      this.yaw[cell] = yaw[k] as number;
    }
  }

  isPerceived(step: number, row: number): boolean {
    return this.sight[step * this.actors + row] === this.seen;
  }

  /** Whether the actor was in the world and the ego did not perceive it. */
  isMissed(step: number, row: number): boolean {
    const sight = this.sight[step * this.actors + row];
    return sight !== undefined && sight !== 255 && sight !== this.seen;
  }

  /** Returns whether and why not an actor is perceived, "" where that is not told. */
  words(step: number, row: number): string {
    const name = this.head.sights[this.sight[step * this.actors + row] ?? 255];
    return name === undefined ? "" : (WORDS[name] ?? name.replaceAll("_", " "));
  }

  /** Returns how many actors are perceived, of how many. */
  counts(step: number): readonly [number, number] {
    let seen = 0;
    let all = 0;
    for (let row = 0; row < this.actors; row++) {
      if (this.isPerceived(step, row)) seen++;
      else if (!this.isMissed(step, row)) continue;
      all++;
    }
    return [seen, all];
  }
}
