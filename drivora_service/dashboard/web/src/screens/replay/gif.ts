import type { MapStage } from "../../roads/MapStage";
import type { Clock } from "./clock";
import { drawWithFoot, FOOT_PX } from "./exporting";
import type { GifSaid, GifTold } from "./gifMessages";
import type { Range } from "./timeScale";

const WIDTH_PX = 720;
const FRAMES_A_SECOND = 10;
const MOST_FRAMES = 900;
/** The last frame stays, so that the end can be seen before the GIF begins again. */
const LAST_MS = 1500;

/** Returns the times that the frames of a GIF show: a tenth of a second apart at the given speed. */
export function gifTimes(range: Range, rate: number): readonly number[] {
  const apart = rate / FRAMES_A_SECOND;
  const count = Math.floor((range.to - range.from) / apart + 1e-6) + 1;
  if (count > MOST_FRAMES)
    throw new Error(
      `the stretch makes ${count} frames, more than ${MOST_FRAMES}: ` +
        "choose a shorter one on the time line, or a higher speed",
    );
  return Array.from({ length: count }, (_, k) => range.from + k * apart);
}

/**
 * Shows the frames of a stretch one after the other and returns them as a GIF, with a line of text
 * below each. A worker encodes them while the page goes on; `signal` gives up.
 */
export async function gif(
  stage: MapStage,
  clock: Clock,
  range: Range,
  text: (time: number) => string,
  signal: AbortSignal,
  onProgress: (share: number) => void,
): Promise<Blob> {
  const times = gifTimes(range, clock.rate);
  const worker = new Worker(new URL("./gif.worker.ts", import.meta.url), { type: "module" });
  let refuse: ((reason: unknown) => void) | undefined;
  worker.onerror = () => refuse?.(new Error("the browser could not encode the GIF"));
  signal.addEventListener("abort", () => refuse?.(signal.reason), { once: true });
  const asked = (said: GifSaid, transfer: Transferable[] = []) =>
    new Promise<GifTold>((resolve, reject) => {
      worker.onmessage = ({ data }: MessageEvent<GifTold>) => resolve(data);
      refuse = reject;
      worker.postMessage(said, transfer);
    });
  const { width, height } = stage.size;
  const scale = Math.min(1, WIDTH_PX / width);
  const sheet = new OffscreenCanvas(
    Math.round(width * scale),
    Math.round(height * scale) + FOOT_PX,
  );
  const pen = sheet.getContext("2d", { willReadFrequently: true });
  if (!pen) throw new Error("the browser cannot draw the GIF");
  const before = clock.time;
  clock.pause();
  try {
    for (const [k, time] of times.entries()) {
      signal.throwIfAborted();
      clock.seek(time);
      drawWithFoot(pen, stage, FOOT_PX, text(time));
      const { data } = pen.getImageData(0, 0, sheet.width, sheet.height);
      const delay = k === times.length - 1 ? LAST_MS : 1000 / FRAMES_A_SECOND;
      const frame = { width: sheet.width, height: sheet.height, delay, rgba: data.buffer };
      await asked(frame, [data.buffer]);
      onProgress((k + 1) / times.length);
    }
    const content = (await asked("end")) as Uint8Array<ArrayBuffer>;
    return new Blob([content], { type: "image/gif" });
  } finally {
    worker.terminate();
    clock.seek(before);
  }
}
