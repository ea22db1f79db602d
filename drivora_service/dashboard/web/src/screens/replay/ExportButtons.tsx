import { useEffect, useRef, useState } from "react";
import type { Clock } from "./clock";
import { picture, save, video, videoType } from "./exporting";
import { gif } from "./gif";
import type { MapHandle } from "./ReplayMap";
import type { Range } from "./timeScale";

/** An export that takes a while, and how much of it is done where that is known. */
type Running = { readonly form: "video" } | { readonly form: "gif"; readonly share: number };

/** Saves the map as a picture, or the stretch that the time line shows as a GIF or a video. */
export function ExportButtons({
  map,
  clock,
  range,
  name,
}: {
  readonly map: () => MapHandle | null;
  readonly clock: Clock;
  readonly range: Range;
  readonly name: string;
}) {
  const [failure, setFailure] = useState("");
  const [running, setRunning] = useState<Running>();
  const stop = useRef<AbortController>(undefined);
  useEffect(() => () => stop.current?.abort(), []);
  const type = videoType();
  const tell = (error: unknown) =>
    setFailure(error instanceof Error ? error.message : String(error));
  const textAt = (time: number) => `${name} · ${time.toFixed(2)} s`;
  const begin = () => {
    setFailure("");
    stop.current = new AbortController();
    return stop.current.signal;
  };
  const savePicture = () => {
    const stage = map()?.stage();
    if (!stage) return;
    setFailure("");
    const at = clock.time.toFixed(2);
    picture(stage, textAt(clock.time)).then((content) => save(content, `${name}-${at}s.png`), tell);
  };
  const saveGif = () => {
    const stage = map()?.stage();
    if (!stage) return;
    const signal = begin();
    setRunning({ form: "gif", share: 0 });
    gif(stage, clock, range, textAt, signal, (share) => setRunning({ form: "gif", share }))
      .then((content) => save(content, `${name}.gif`))
      .catch((error: unknown) => {
        if (!signal.aborted) tell(error);
      })
      .finally(() => setRunning(undefined));
  };
  const saveVideo = () => {
    const stage = map()?.stage();
    if (!stage) return;
    const signal = begin();
    setRunning({ form: "video" });
    video(stage, clock, range, signal)
      .then((content) => save(content, `${name}.${type.includes("mp4") ? "mp4" : "webm"}`), tell)
      .finally(() => setRunning(undefined));
  };
  if (running)
    return (
      <span className="exporting">
        {running.form === "gif" ? (
          <>
            <progress aria-label="Saving the GIF" max={1} value={running.share} />
            <span className="share">GIF {Math.floor(100 * running.share)} %</span>
          </>
        ) : (
          <span>Recording the video</span>
        )}
        <button
          type="button"
          onClick={() => stop.current?.abort()}
          title={running.form === "gif" ? "Save no GIF" : "Save the video up to here"}
        >
          {running.form === "gif" ? "Cancel" : "Stop"}
        </button>
      </span>
    );
  return (
    <>
      <button type="button" onClick={savePicture} title="Save the map as a picture">
        PNG
      </button>
      <button
        type="button"
        onClick={saveGif}
        title="Save the stretch that the time line shows, at the chosen speed, as a GIF"
      >
        GIF
      </button>
      {type && (
        <button
          type="button"
          onClick={saveVideo}
          title="Play the stretch that the time line shows, at the chosen speed, and save it as a video"
        >
          Video
        </button>
      )}
      {failure && <span role="alert">{failure}</span>}
    </>
  );
}
