/** What the page tells the worker that encodes a GIF: its frames in order, then the end. */
export type GifSaid =
  | {
      readonly width: number;
      readonly height: number;
      /** Milliseconds. */
      readonly delay: number;
      readonly rgba: ArrayBuffer;
    }
  | "end";

/** What the worker tells the page: that a frame is encoded, or the whole file. */
export type GifTold = "frame" | Uint8Array<ArrayBuffer>;
