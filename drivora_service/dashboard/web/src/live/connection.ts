import { addressOf } from "../service";
import { read, type Told } from "./messages";

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 8000;

/** One stream of events: after each break it goes on where it was, so that nothing is missed. */
export class Connection {
  private source: EventSource | undefined;
  private after = "";
  private wait = FIRST_WAIT_MS;
  private timer: ReturnType<typeof setTimeout> | undefined;
  live = false;

  constructor(private readonly tell: (told: Told) => void) {
    this.open();
  }

  private open(): void {
    this.timer = undefined;
    const from = this.after ? `?after=${this.after}` : "";
    const source = new EventSource(addressOf(`/api/v1/events${from}`));
    this.source = source;
    source.addEventListener("begin", (event) => {
      this.wait = FIRST_WAIT_MS;
      // The id also names the database, so that another one is noticed.
      this.after =
        event.lastEventId || String((JSON.parse(event.data) as { revision: number }).revision);
      this.setLive(true);
    });
    for (const name of ["changes", "workers", "reset"]) {
      source.addEventListener(name, (event: MessageEvent<string>) => {
        if (event.lastEventId) this.after = event.lastEventId;
        const told = read(name, event.data);
        if (told) this.tell(told);
      });
    }
    source.onerror = () => {
      // The browser's own repetition gives up after some answers; this one never does.
      source.close();
      this.setLive(false);
      this.timer = setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(this.wait * 2, LONGEST_WAIT_MS);
    };
  }

  /** Connects at once where the next attempt would be later, as after a sign-in. */
  again(): void {
    if (this.timer === undefined) return;
    clearTimeout(this.timer);
    this.wait = FIRST_WAIT_MS;
    this.open();
  }

  close(): void {
    clearTimeout(this.timer);
    this.source?.close();
  }

  private setLive(live: boolean): void {
    if (live === this.live) return;
    this.live = live;
    this.tell({ type: "state", live });
  }
}
