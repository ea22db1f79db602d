import type { MapStage } from "../../roads/MapStage";
import type { Clock } from "./clock";
import type { Range } from "./timeScale";

/** Height of the line of text below a picture. */
export const FOOT_PX = 30;
const FRAMES_A_SECOND = 30;
const VIDEO_TYPES = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];

/** Saves content as a file of the reader. */
export function save(content: Blob, name: string): void {
  const address = URL.createObjectURL(content);
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/** Draws the map as it is over the whole of a canvas, with a line of text below it. */
export function drawWithFoot(
  pen: OffscreenCanvasRenderingContext2D,
  stage: MapStage,
  foot: number,
  text: string,
): void {
  const { width, height } = pen.canvas;
  const style = getComputedStyle(document.documentElement);
  pen.fillStyle = style.getPropertyValue("--raised");
  pen.fillRect(0, 0, width, height);
  // Drawn in this moment: a canvas of WebGL is empty after its frame was shown.
  stage.drawNow();
  pen.drawImage(stage.canvas, 0, 0, width, height - foot);
  pen.fillStyle = style.getPropertyValue("--ink");
  pen.font = `${(13 * foot) / FOOT_PX}px system-ui, sans-serif`;
  pen.textBaseline = "middle";
  pen.fillText(text, foot / 3, height - foot / 2);
}

/** Returns the map as it is, with a line of text below it, as a PNG. */
export async function picture(stage: MapStage, text: string): Promise<Blob> {
  const { canvas } = stage;
  const foot = Math.round((FOOT_PX * canvas.width) / Math.max(stage.size.width, 1));
  const whole = new OffscreenCanvas(canvas.width, canvas.height + foot);
  const pen = whole.getContext("2d");
  if (!pen) throw new Error("the browser cannot draw the picture");
  drawWithFoot(pen, stage, foot, text);
  return whole.convertToBlob({ type: "image/png" });
}

/** Returns the form in which this browser records videos, "" if it cannot. */
export function videoType(): string {
  if (typeof MediaRecorder === "undefined") return "";
  return VIDEO_TYPES.find((type) => MediaRecorder.isTypeSupported(type)) ?? "";
}

/** Plays a stretch and returns it as a video; pausing or `signal` ends it there. */
export function video(
  stage: MapStage,
  clock: Clock,
  range: Range,
  signal: AbortSignal,
): Promise<Blob> {
  return new Promise((resolve, reject) => {
    const stream = stage.canvas.captureStream(FRAMES_A_SECOND);
    const recorder = new MediaRecorder(stream, {
      mimeType: videoType(),
      videoBitsPerSecond: 8_000_000,
    });
    const parts: Blob[] = [];
    let begun = false;
    const end = () => {
      stop();
      signal.removeEventListener("abort", end);
      clock.until = Number.POSITIVE_INFINITY;
      clock.pause();
      if (recorder.state !== "inactive") recorder.stop();
      for (const track of stream.getTracks()) track.stop();
    };
    recorder.ondataavailable = ({ data }) => parts.push(data);
    recorder.onerror = () => reject(new Error("the browser could not record the video"));
    recorder.onstop = () => resolve(new Blob(parts, { type: recorder.mimeType }));
    const stop = clock.listen(() => {
      if (begun && !clock.playing) end();
    });
    signal.addEventListener("abort", end);
    clock.pause();
    clock.seek(range.from);
    stage.drawNow();
    // Not a frame beyond the stretch: the time line would move on with it.
    clock.until = range.to;
    recorder.start(250);
    begun = true;
    clock.play();
  });
}
