import { useSearch } from "@tanstack/react-router";
import { useEffect, useMemo, useRef, useState } from "react";
import type { Schemas } from "../../api/client";
import { CopyLink } from "../../components/CopyLink";
import { Loading, Refused } from "../../components/States";
import { type Camera, cameraText } from "../../roads/camera";
import { useGeometry } from "../../roads/useGeometry";
import { serviceAddress } from "../../service";
import { useKeys } from "../../shell/keys";
import { ActorList } from "./ActorList";
import { AgentLog } from "./AgentLog";
import { readState, stretchWords, TRAILS, trailsText } from "./address";
import { rejudgeCommand } from "./againCommand";
import { avoidableUntil } from "./avoidable";
import { CompareChoice } from "./CompareChoice";
import { Caption, CompareLine } from "./CompareLine";
import { Controls } from "./Controls";
import { Clock } from "./clock";
import { EgoFacts } from "./EgoFacts";
import { ExportButtons } from "./ExportButtons";
import { lawCurves } from "./lawCurves";
import { focusOf } from "./opening";
import { Plots } from "./Plots";
import { FOLLOW_SCALE, type MapHandle, ReplayMap } from "./ReplayMap";
import type { Recording } from "./recording";
import { TimeLine } from "./TimeLine";
import { holding, isPart, type Range, withinRun } from "./timeScale";
import { useAddressWriter } from "./useAddressWriter";
import { useAgentTold } from "./useAgentTold";
import { usePerception } from "./usePerception";
import { useRecording } from "./useRecording";
import { useSecondRun } from "./useSecondRun";
import { useSeries } from "./useSeries";
import { useTimeline } from "./useTimeline";
import { VerdictLine } from "./VerdictLine";
import { gravestFirst } from "./verdictWords";

const NONE: readonly Schemas["ViolationMark"][] = [];

/** Loads what a replay needs, and shows it as soon as its first part is there. */
export function Replay({ run }: { readonly run: Schemas["Run"] }) {
  const geometry = useGeometry(run.town);
  const { recording, loaded, error } = useRecording(run.id);
  const failure = error ?? geometry.error;
  if (failure) return <Refused error={failure} />;
  if (!recording || !geometry.data) return <Loading rows={14} />;
  return <Player run={run} recording={recording} loaded={loaded} geometry={geometry.data} />;
}

function Player({
  run,
  recording,
  loaded,
  geometry,
}: {
  readonly run: Schemas["Run"];
  readonly recording: Recording;
  readonly loaded: number;
  readonly geometry: Schemas["NetworkGeometry"];
}) {
  const search = useSearch({ from: "/runs/$runId" });
  const state = readState(search);
  const clock = useMemo(() => new Clock(recording.duration, recording.stepLength), [recording]);
  const map = useRef<MapHandle>(null);
  const ego = Math.max(
    recording.actors
      .slice(0, recording.egos)
      .findIndex(({ id }) => id === (state.ego || state.follow)),
    0,
  );
  // As the address says, until it is moved.
  const [asked] = useState(() => withinRun(state.stretch, clock.end));
  const [range, setRange] = useState<Range>(() =>
    holding(asked, Math.min(state.time, clock.end), clock.end),
  );
  const series = useSeries(run.id, ego);
  const perception = usePerception(
    run.id,
    ego,
    recording.steps,
    recording.actors.length,
    state.perceived,
  );
  const second = useSecondRun(recording, clock, state.beside, ego, state.pace);
  const { data: otherTimeline } = useTimeline(state.view === "side" ? state.beside : "");
  const beside = useRef<MapHandle>(null);
  const told = useAgentTold(run.id, recording, loaded >= recording.steps);
  const [measuring, setMeasuring] = useState(false);
  const begun = useRef(false);
  if (!begun.current) {
    begun.current = true;
    clock.seek(state.time);
  }
  useEffect(() => () => clock.pause(), [clock]);

  const put = useAddressWriter();
  useEffect(
    () =>
      clock.listen(() => {
        if (!clock.playing) put({ t: clock.time > 0 ? clock.time.toFixed(2) : undefined });
      }),
    [clock, put],
  );
  useEffect(
    () => clock.listen(() => setRange((before) => holding(before, clock.time, clock.end))),
    [clock],
  );
  const settled = useRef(asked);
  useEffect(() => {
    if (settled.current === range) return;
    settled.current = range;
    put(stretchWords(range, clock.end));
  }, [range, clock, put]);

  // Without a word it is the ego that is followed, or the first.
  const egoWord = (row: number, followed = state.follow) =>
    row === 0 && !followed ? undefined : recording.actors[row]?.id;
  const follow = (id: string) => {
    const actor = recording.actors.find((one) => one.id === id);
    const camera = (id || state.follow) && map.current?.stage()?.camera;
    put(
      {
        follow: id || undefined,
        ...(actor && actor.row < recording.egos ? { ego: egoWord(actor.row, id) } : {}),
        // A link shows as much of the map as is seen now.
        ...(camera ? { camera: cameraText(id ? nearEnough(camera) : camera) } : {}),
      },
      true,
    );
  };
  const hide = (id: string) => {
    const hidden = state.hidden.includes(id)
      ? state.hidden.filter((one) => one !== id)
      : [...state.hidden, id];
    put({ hide: hidden }, true);
  };
  const moments = useMemo(
    () =>
      [...new Set(gravestFirst(run.verdicts).flatMap(({ time }) => time ?? []))].sort(
        (a, b) => a - b,
      ),
    [run],
  );
  const egoId = recording.actors.find(({ row }) => row === ego)?.id ?? "";
  const laws = useMemo(() => lawCurves(run.verdicts, egoId), [run, egoId]);
  const { data: timeline } = useTimeline(run.id);
  const jump = (time: number) => {
    clock.pause();
    clock.seek(time);
  };
  const jumpBy = (by: 1 | -1) => {
    const ahead =
      by > 0
        ? moments.find((time) => time > clock.time + 1e-3)
        : moments.findLast((time) => time < clock.time - 1e-3);
    if (ahead !== undefined) jump(ahead);
  };
  const togglePerceived = () => put({ perceived: state.perceived ? undefined : "yes" }, true);
  const aSecond = Math.round(1 / recording.stepLength);
  useKeys([
    { keys: "space", does: "play or pause", run: () => clock.toggle() },
    { keys: "left", does: "one step back", run: () => clock.toStep(clock.step - 1) },
    { keys: "right", does: "one step ahead", run: () => clock.toStep(clock.step + 1) },
    { keys: "shift+left", does: "one second back", run: () => clock.toStep(clock.step - aSecond) },
    {
      keys: "shift+right",
      does: "one second ahead",
      run: () => clock.toStep(clock.step + aSecond),
    },
    { keys: "home", does: "to the start", run: () => clock.toStep(0) },
    { keys: "end", does: "to the end", run: () => clock.toStep(clock.lastStep) },
    { keys: "[", does: "previous verdict", run: () => jumpBy(-1) },
    { keys: "]", does: "next verdict", run: () => jumpBy(1) },
    { keys: ">", does: "faster", run: () => clock.changeRate(1) },
    { keys: "<", does: "slower", run: () => clock.changeRate(-1) },
    { keys: "f", does: "show the whole run", run: () => map.current?.fit() },
    { keys: "z", does: "the whole time line", run: () => showWhole() },
    { keys: "+", does: "nearer", run: () => map.current?.zoom(1.4) },
    { keys: "-", does: "farther", run: () => map.current?.zoom(1 / 1.4) },
    { keys: "m", does: "measure", run: () => setMeasuring(!measuring) },
    { keys: "v", does: "perceived or true", run: () => togglePerceived() },
    { keys: "0", does: "follow no actor", run: () => follow("") },
    ...recording.actors.slice(0, 9).map((actor, place) => ({
      keys: String(place + 1),
      does: `follow ${actor.id}`,
      run: () => follow(actor.id),
    })),
  ]);
  const showWhole = () => {
    if (isPart(range, clock.end)) setRange({ from: 0, to: clock.end });
  };
  const keepCamera = (camera: Camera) => put({ camera: cameraText(camera) });

  return (
    <div className="replay">
      <VerdictLine
        run={run}
        untilOf={avoidableUntil}
        onMoment={jump}
        rejudge={rejudgeCommand(run, serviceAddress())}
      />
      {state.beside && (
        <CompareLine
          other={second.run}
          parting={second.compared?.parting}
          ready={second.compared !== undefined}
          failure={second.failure}
          view={state.view}
          pace={state.pace}
          put={(changes) => put(changes, true)}
          onMoment={jump}
        />
      )}
      <div className="maps">
        <ReplayMap
          ref={map}
          caption={state.view === "side" && second.compared && <Caption place="1st" run={run} />}
          over={state.view === "over" ? second.compared : undefined}
          geometry={geometry}
          recording={recording}
          loaded={loaded}
          clock={clock}
          violations={timeline?.violations ?? NONE}
          state={state}
          focus={focusOf(recording.actors, run, state.ego)}
          told={told.data}
          perceived={state.perceived ? perception.data : undefined}
          measuring={measuring}
          onCamera={(camera, byHand) => {
            if (byHand) keepCamera(camera);
            // Maps that follow an actor go their own ways.
            if (byHand || !state.follow) beside.current?.look(camera);
          }}
          onFollow={follow}
        />
        {state.view === "side" && second.compared && (
          <ReplayMap
            ref={beside}
            label="The second run on the map"
            caption={second.run && <Caption place="2nd" run={second.run} />}
            geometry={geometry}
            recording={second.compared.recording}
            loaded={second.compared.recording.loaded}
            clock={second.compared.moment}
            violations={otherTimeline?.violations ?? NONE}
            state={{ ...state, camera: map.current?.stage()?.camera ?? state.camera }}
            told={undefined}
            perceived={undefined}
            measuring={measuring}
            onCamera={(camera, byHand) => {
              if (!byHand) return;
              keepCamera(camera);
              map.current?.look(camera);
            }}
            onFollow={follow}
          />
        )}
      </div>
      <aside className="beside">
        <section className="panel ego" aria-label="Ego">
          <header>
            <h2>
              <span className="actor" data-role="ego">
                <i style={{ color: `var(--ego-${ego % 6})` }} />
                {recording.actors[ego]?.id}
              </span>
            </h2>
            {recording.egos > 1 && (
              <select
                aria-label="Ego"
                value={ego}
                onChange={(event) => put({ ego: egoWord(Number(event.target.value)) }, true)}
              >
                {recording.actors.slice(0, recording.egos).map(({ row, id }) => (
                  <option key={id} value={row}>
                    {id}
                  </option>
                ))}
              </select>
            )}
          </header>
          <div className="inside">
            <EgoFacts
              told={told.data}
              recording={recording}
              clock={clock}
              ego={ego}
              series={series.data}
              perceived={state.perceived ? perception.data : undefined}
            />
          </div>
        </section>
        <ActorList
          recording={recording}
          clock={clock}
          ego={ego}
          followed={state.follow}
          hidden={state.hidden}
          perceived={state.perceived ? perception.data : undefined}
          onFollow={follow}
          onHide={hide}
        />
        {recording.log.length > 0 && <AgentLog recording={recording} clock={clock} ego={ego} />}
      </aside>
      <Controls clock={clock}>
        <CopyLink />
        <label>
          Follow{" "}
          <select value={state.follow} onChange={(event) => follow(event.target.value)}>
            <option value="">no actor</option>
            {recording.actors
              .filter(({ role }) => role !== "npc_obstacle")
              .map(({ id }) => (
                <option key={id} value={id}>
                  {id}
                </option>
              ))}
          </select>
        </label>
        <label>
          Trails{" "}
          <select
            value={state.trails}
            onChange={(event) => put({ trails: trailsText(Number(event.target.value)) }, true)}
          >
            {TRAILS.map((seconds) => (
              <option key={seconds} value={seconds}>
                {seconds === 0 ? "none" : seconds >= 1e6 ? "whole" : `${seconds} s`}
              </option>
            ))}
          </select>
        </label>
        <button
          type="button"
          aria-pressed={state.routes}
          onClick={() => put({ routes: state.routes ? "no" : undefined }, true)}
        >
          Routes
        </button>
        <button
          type="button"
          aria-pressed={state.perceived}
          onClick={togglePerceived}
          title="Where the ego perceived the other actors, and which it missed (v)"
        >
          Perceived
        </button>
        <button
          type="button"
          aria-pressed={measuring}
          onClick={() => setMeasuring(!measuring)}
          title="Click two places (m)"
        >
          Measure
        </button>
        <button type="button" onClick={() => map.current?.fit()} title="Show the whole run (f)">
          Fit
        </button>
        {!state.beside && <CompareChoice run={run} put={(changes) => put(changes, true)} />}
        <ExportButtons
          map={() => map.current}
          clock={clock}
          range={range}
          name={run.label || run.id}
        />
        {state.perceived && perception.error && (
          <span className="quiet">{perception.error.message}</span>
        )}
      </Controls>
      <TimeLine
        clock={clock}
        recording={recording}
        timeline={timeline}
        range={range}
        onRange={setRange}
      />
      {series.data && (
        <Plots
          series={series.data}
          clock={clock}
          ego={ego}
          agent={run.agents?.[egoId]?.name ?? run.agent}
          range={range}
          onRange={setRange}
          difference={second.compared?.difference}
          laws={laws}
        />
      )}
      {series.error && <Refused error={series.error} />}
    </div>
  );
}

function nearEnough(camera: Camera): Camera {
  return { ...camera, scale: Math.max(camera.scale, FOLLOW_SCALE) };
}
