/** Speeds of a replay, in seconds of the run a second. */
export const RATES = [0.1, 0.25, 0.5, 1, 2, 5, 10] as const;

/** The time of a replay. It runs only while it plays; listeners are called with each new time. */
export class Clock {
  time = 0;
  playing = false;
  rate = 1;
  /** Where playing stops, at most the end. */
  until = Number.POSITIVE_INFINITY;
  private readonly listeners = new Set<() => void>();
  private frame = 0;
  private before = 0;

  constructor(
    public end: number,
    readonly stepLength: number,
  ) {}

  get step(): number {
    return Math.min(Math.floor(this.time / this.stepLength + 1e-6), this.lastStep);
  }

  get lastStep(): number {
    return Math.round(this.end / this.stepLength);
  }

  listen = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => {
      this.listeners.delete(listener);
    };
  };

  seek(time: number): void {
    const bounded = Math.min(Math.max(time, 0), this.end);
    if (bounded === this.time) return;
    this.time = bounded;
    this.tell();
  }

  /** Goes to a step and stands there. */
  toStep(step: number): void {
    this.pause();
    this.seek(step * this.stepLength);
  }

  play(): void {
    if (this.playing) return;
    if (this.time >= this.end) this.time = 0;
    this.playing = true;
    this.before = performance.now();
    this.frame = requestAnimationFrame(this.tick);
    this.tell();
  }

  pause(): void {
    if (!this.playing) return;
    this.playing = false;
    cancelAnimationFrame(this.frame);
    this.tell();
  }

  toggle(): void {
    if (this.playing) this.pause();
    else this.play();
  }

  setRate(rate: number): void {
    this.rate = rate;
    this.tell();
  }

  /** Chooses the next faster or slower rate. */
  changeRate(by: 1 | -1): void {
    const place = (RATES as readonly number[]).indexOf(this.rate);
    this.setRate(RATES[Math.min(Math.max(place + by, 0), RATES.length - 1)] ?? 1);
  }

  private tick = (now: number): void => {
    if (!this.playing) return;
    const passed = Math.max(now - this.before, 0) / 1000;
    this.before = now;
    const last = Math.min(this.end, this.until);
    this.time = Math.min(this.time + passed * this.rate, last);
    if (this.time >= last) this.playing = false;
    else this.frame = requestAnimationFrame(this.tick);
    this.tell();
  };

  private tell(): void {
    for (const listener of this.listeners) listener();
  }
}
