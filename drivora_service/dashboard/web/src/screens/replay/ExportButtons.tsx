import { useRef, useState } from "react";
import type { Clock } from "./clock";
import { picture, save, video, videoType } from "./exporting";
import type { MapHandle } from "./ReplayMap";
import type { Range } from "./timeScale";

/** Saves the map as a picture, or the stretch that the time line shows as a video. */
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
  const [recording, setRecording] = useState(false);
  const stop = useRef<AbortController>(undefined);
  const type = videoType();
  const tell = (error: unknown) =>
    setFailure(error instanceof Error ? error.message : String(error));
  const savePicture = () => {
    const stage = map()?.stage();
    if (!stage) return;
    setFailure("");
    const at = clock.time.toFixed(2);
    picture(stage, `${name} · ${at} s`).then(
      (content) => save(content, `${name}-${at}s.png`),
      tell,
    );
  };
  const saveVideo = () => {
    const stage = map()?.stage();
    if (!stage) return;
    if (recording) return stop.current?.abort();
    setFailure("");
    setRecording(true);
    stop.current = new AbortController();
    video(stage, clock, range, stop.current.signal)
      .then((content) => save(content, `${name}.${type.includes("mp4") ? "mp4" : "webm"}`), tell)
      .finally(() => setRecording(false));
  };
  return (
    <>
      <button type="button" onClick={savePicture} title="Save the map as a picture">
        PNG
      </button>
      {type && (
        <button
          type="button"
          aria-pressed={recording}
          onClick={saveVideo}
          title="Play the stretch that the time line shows, at the chosen speed, and save it as a video"
        >
          {recording ? "Stop" : "Video"}
        </button>
      )}
      {failure && <span role="alert">{failure}</span>}
    </>
  );
}
