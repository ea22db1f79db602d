/// <reference lib="webworker" />
import { applyPalette, GIFEncoder, quantize } from "gifenc";
import type { GifSaid, GifTold } from "./gifMessages";

/** Of the 256 of a frame, one is for pixels that stay. */
const COLOURS = 255;
const KEEP = 1;

const encoder = GIFEncoder();
let before: Uint32Array | undefined;

/**
 * Adds a frame. Only pixels that have changed are written, in colours of their own: the road stays
 * as it is, so that the file is a fraction of one with whole frames.
 */
function add(now: Uint32Array, width: number, height: number, delay: number): void {
  const places: number[] = [];
  for (let place = 0; place < now.length; place++)
    if (now[place] !== before?.[place]) places.push(place);
  const colours = Uint32Array.from(places, (place) => now[place] as number);
  const rgba = new Uint8Array(colours.buffer);
  const palette = places.length > 0 ? quantize(rgba, COLOURS) : [];
  const found = places.length > 0 ? applyPalette(rgba, palette) : new Uint8Array();
  const keep = palette.length;
  palette.push([0, 0, 0]);
  const index = new Uint8Array(now.length).fill(keep);
  places.forEach((place, k) => {
    index[place] = found[k] as number;
  });
  encoder.writeFrame(index, width, height, {
    palette,
    delay,
    transparent: before !== undefined,
    transparentIndex: keep,
    dispose: KEEP,
  });
  before = now;
}

const tell = (told: GifTold) => self.postMessage(told);

self.onmessage = ({ data }: MessageEvent<GifSaid>) => {
  if (data === "end") {
    encoder.finish();
    tell(encoder.bytes());
    return;
  }
  add(new Uint32Array(data.rgba), data.width, data.height, data.delay);
  tell("frame");
};
