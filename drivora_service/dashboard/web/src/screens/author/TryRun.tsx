import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { useEffect, useMemo, useRef, useState } from "react";
import type { Schemas } from "../../api/client";
import { Mark } from "../../components/Mark";
import { Loading, Refused } from "../../components/States";
import type { Camera } from "../../roads/camera";
import { useKeys } from "../../shell/keys";
import { readState } from "../replay/address";
import { avoidableUntil } from "../replay/avoidable";
import { Controls } from "../replay/Controls";
import { Clock } from "../replay/clock";
import { type MapHandle, ReplayMap } from "../replay/ReplayMap";
import type { Recording } from "../replay/recording";
import { runQuery } from "../replay/runQuery";
import { TimeLine } from "../replay/TimeLine";
import type { Range } from "../replay/timeScale";
import { useRecording } from "../replay/useRecording";
import { useTimeline } from "../replay/useTimeline";
import { VerdictLine } from "../replay/VerdictLine";
import { lookOfRun } from "../runs/status";

const ASK_AGAIN_MS = 500;
const SIGHT_PX = 350;

/** A run of the scenario that is written, on the map where it is written. */
export function TryRun({
  id,
  geometry,
  camera,
  editedFrom,
  onBack,
}: {
  readonly id: string;
  /** The id of the run whose scenario was edited; "" for none. */
  readonly editedFrom: string;
  readonly geometry: Schemas["NetworkGeometry"];
  readonly camera: Camera | undefined;
  readonly onBack: () => void;
}) {
  const { data: run, error } = useQuery({
    ...runQuery(id),
    refetchInterval: ({ state }) => (isOver(state.data) ? false : ASK_AGAIN_MS),
  });
  const { recording, loaded, error: unread } = useRecording(run?.trace_sha256 ? id : "");
  useKeys([{ keys: "escape", does: "back to editing", run: onBack }]);
  return (
    <div className="author-try">
      <p className="author-try-line">
        <button type="button" onClick={onBack} title="Back to editing (escape)">
          Back to editing
        </button>
        {run && <Mark {...lookOfRun(run)} />}
        <Link to="/runs/$runId" params={{ runId: id }} search={{}}>
          The run with all its values
        </Link>
        {run?.trace_sha256 && editedFrom && <CompareLink id={id} editedFrom={editedFrom} />}
        {run?.error && <span className="problem">{run.error.message}</span>}
      </p>
      {error || unread ? (
        <Refused error={error ?? unread} />
      ) : run && recording && loaded > 0 ? (
        <Player
          run={run}
          recording={recording}
          loaded={loaded}
          geometry={geometry}
          camera={camera}
        />
      ) : isOver(run) && run && !run.trace_sha256 ? null : (
        <Loading rows={8} />
      )}
    </div>
  );
}

/** Leads to both runs in step, if the one that was edited is still there and recorded. */
function CompareLink({ id, editedFrom }: { readonly id: string; readonly editedFrom: string }) {
  const { data: before } = useQuery({ ...runQuery(editedFrom), retry: false });
  if (!before) return null;
  if (!before.trace_sha256)
    return (
      <span className="quiet">The run it was edited from has no recording to compare with</span>
    );
  return (
    <Link
      to="/runs/$runId"
      params={{ runId: id }}
      search={{ with: editedFrom }}
      title={before.label || editedFrom}
    >
      Compare with the run it was edited from
    </Link>
  );
}

function isOver(run: Schemas["Run"] | undefined): boolean {
  return run !== undefined && run.status !== "queued" && run.status !== "running";
}

function Player({
  run,
  recording,
  loaded,
  geometry,
  camera,
}: {
  readonly run: Schemas["Run"];
  readonly recording: Recording;
  readonly loaded: number;
  readonly geometry: Schemas["NetworkGeometry"];
  readonly camera: Camera | undefined;
}) {
  const clock = useMemo(() => new Clock(recording.duration, recording.stepLength), [recording]);
  const [follow, setFollow] = useState("");
  const [range, setRange] = useState<Range>({ from: 0, to: clock.end });
  const map = useRef<MapHandle>(null);
  const { data: timeline } = useTimeline(run.id);
  // The map stands where the reader was writing, unless no ego begins there.
  const [first] = useState(() => (camera && seesEgo(camera, recording) ? camera : undefined));
  const state = useMemo(() => ({ ...readState({}), camera: first, follow }), [first, follow]);
  useEffect(() => {
    clock.play();
    return () => clock.pause();
  }, [clock]);
  useKeys([
    { keys: "space", does: "play or pause", run: () => clock.toggle() },
    { keys: "right", does: "one step ahead", run: () => clock.toStep(clock.step + 1) },
    { keys: "left", does: "one step back", run: () => clock.toStep(clock.step - 1) },
    { keys: "f", does: "show the whole run", run: () => map.current?.fit() },
  ]);
  const violations = timeline?.violations ?? [];
  return (
    <>
      <VerdictLine
        run={run}
        untilOf={avoidableUntil}
        onMoment={(time) => {
          clock.pause();
          clock.seek(time);
        }}
      />
      <ReplayMap
        ref={map}
        geometry={geometry}
        recording={recording}
        loaded={loaded}
        clock={clock}
        violations={violations}
        state={state}
        perceived={undefined}
        told={undefined}
        measuring={false}
        onCamera={() => undefined}
        onFollow={setFollow}
      />
      <Controls clock={clock} />
      <TimeLine
        clock={clock}
        recording={recording}
        timeline={timeline}
        range={range}
        onRange={setRange}
      />
    </>
  );
}

/** Whether an ego begins near the middle of a camera, as far as most windows reach. */
function seesEgo({ x, y, scale }: Camera, recording: Recording): boolean {
  const reach = SIGHT_PX / scale;
  return Array.from({ length: recording.egos }).some(
    (_, ego) => Math.hypot((recording.x[ego] ?? 0) - x, (recording.y[ego] ?? 0) - y) < reach,
  );
}
