import type { Clock } from "./clock";

/** A time that a map shows. */
export interface Moment {
  readonly time: number;
  readonly step: number;
  readonly playing: boolean;
  readonly listen: (listener: () => void) => () => void;
}

/** The time of a second run that is kept in step with a clock. */
export class Follower implements Moment {
  constructor(
    private readonly clock: Clock,
    private readonly times: Float64Array,
    private readonly stepLength: number,
  ) {}

  get time(): number {
    const at = this.clock.time / this.clock.stepLength;
    const step = Math.floor(at + 1e-6);
    const here = this.times[Math.min(step, this.times.length - 1)] ?? 0;
    const next = this.times[Math.min(step + 1, this.times.length - 1)] ?? here;
    return here + Math.max(at - step, 0) * (next - here);
  }

  get step(): number {
    return Math.floor(this.time / this.stepLength + 1e-6);
  }

  get playing(): boolean {
    return this.clock.playing;
  }

  listen = (listener: () => void): (() => void) => this.clock.listen(listener);
}
