import { Fragment, useEffect, useRef } from "react";
import type { Schemas } from "../../api/client";
import type { Clock } from "./clock";
import { stripsOf } from "./lightStrips";
import type { Recording } from "./recording";
import { isPart, type Range, seatsOf, shifted, ticks, zoomRange } from "./timeScale";
import { oracleName, toneOf, untilWords } from "./verdictWords";
import "./timeline.css";

const ROW_PX = 20;
const MARK_PX = 19;

/** Which of the marks of one moment stays at its place. */
const WEIGHTS = { bad: 2, lost: 1, quiet: 0 } as const;

/** The run's time from left to right: a click goes there, the wheel comes nearer. */
export function TimeLine({
  clock,
  recording,
  timeline,
  range,
  onRange,
}: {
  readonly clock: Clock;
  readonly recording: Recording;
  readonly timeline: Schemas["Timeline"] | undefined;
  readonly range: Range;
  readonly onRange: (range: Range) => void;
}) {
  const track = useRef<HTMLDivElement>(null);
  const cursor = useRef<HTMLDivElement>(null);
  const current = useRef(range);
  current.current = range;
  const latest = useRef(onRange);
  latest.current = onRange;

  useEffect(() => {
    const show = () => {
      const { from, to } = current.current;
      const share = (clock.time - from) / (to - from);
      const element = cursor.current;
      if (!element) return;
      element.style.left = `${100 * share}%`;
      element.hidden = share < 0 || share > 1;
    };
    show();
    return clock.listen(show);
  }, [clock]);
  // The cursor's place changes with the range as well.
  useEffect(() => {
    const element = cursor.current;
    if (!element) return;
    const share = (clock.time - range.from) / (range.to - range.from);
    element.style.left = `${100 * share}%`;
    element.hidden = share < 0 || share > 1;
  }, [clock, range]);

  const timeAt = (event: { readonly clientX: number }) => {
    const box = track.current?.getBoundingClientRect();
    if (!box) return 0;
    const share = Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1);
    return range.from + share * (range.to - range.from);
  };
  useEffect(() => {
    const element = track.current;
    if (!element) return;
    const wheel = (event: WheelEvent) => {
      event.preventDefault();
      const box = element.getBoundingClientRect();
      const { from, to } = current.current;
      const sideways = event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY);
      const by = ((event.deltaX || event.deltaY) / box.width) * (to - from);
      const at = from + ((event.clientX - box.left) / box.width) * (to - from);
      latest.current(
        sideways
          ? shifted({ from, to }, by, clock.end)
          : zoomRange({ from, to }, at, Math.exp(-event.deltaY * 0.002), clock.end),
      );
    };
    element.addEventListener("wheel", wheel, { passive: false });
    return () => element.removeEventListener("wheel", wheel);
  }, [clock]);

  const share = (time: number) => `${(100 * (time - range.from)) / (range.to - range.from)}%`;
  const seconds = (step: number) => step * recording.stepLength;
  const violations = timeline?.violations ?? [];
  const seats = seatsOf(
    violations.map((violation) => ({
      row: violation.ego,
      time: violation.first === null ? -1 : seconds(violation.first),
      weight: WEIGHTS[toneOf(violation)],
    })),
    (MARK_PX * (range.to - range.from)) / (track.current?.clientWidth ?? 1000),
  );
  const across = (time: number) => `${(100 * time) / (range.to - range.from)}%`;
  const inside = (time: number) => time >= range.from - 1e-6 && time <= range.to + 1e-6;
  const withRisk = violations.find(({ risk_perceived }) => risk_perceived !== null);
  const withUntil = violations.find(({ avoidable_until }) => avoidable_until !== null);
  const egos = recording.actors.slice(0, recording.egos);
  return (
    <div className="timeline panel whole-width">
      <div className="names">
        <span>
          {isPart(range, clock.end) && (
            <button
              type="button"
              className="whole"
              onClick={() => onRange({ from: 0, to: clock.end })}
              title="Show the whole time line (z)"
            >
              Whole run
            </button>
          )}
        </span>
        {egos.map(({ id }) => (
          <span key={id} title={id}>
            {id}
          </span>
        ))}
      </div>
      {/* biome-ignore lint/a11y/noStaticElementInteractions: the cursor in it is the control */}
      <div
        ref={track}
        className="track"
        onPointerDown={(event) => {
          if (event.target instanceof Element && event.target.closest("button")) return;
          event.currentTarget.setPointerCapture(event.pointerId);
          clock.pause();
          clock.seek(timeAt(event));
        }}
        onPointerMove={(event) => {
          if (event.currentTarget.hasPointerCapture(event.pointerId)) clock.seek(timeAt(event));
        }}
        onDoubleClick={() => onRange({ from: 0, to: clock.end })}
        style={{ height: ROW_PX * (egos.length + 1) }}
      >
        {ticks(range, 10).map((time) => (
          <span key={time} className="tick" style={{ left: share(time) }}>
            {time - range.from < 0.97 * (range.to - range.from) && time}
          </span>
        ))}
        {egos.map(({ id, row }) => {
          const end = (recording.ends[row]?.step ?? 0) * recording.stepLength;
          const begin = (recording.presence(row)?.[0] ?? 0) * recording.stepLength;
          return (
            <span
              key={id}
              className="part"
              title={`${id}: ${recording.ends[row]?.end.replaceAll("_", " ")} at ${end.toFixed(2)} s`}
              style={{
                top: ROW_PX * (row + 1),
                left: share(begin),
                width: across(end - begin),
                background: `var(--ego-${row % 6})`,
              }}
            />
          );
        })}
        {egos.flatMap(({ row }) =>
          stripsOf(timeline, row, recording.stepLength).map((strip) => (
            <span
              key={`${row} ${strip.first} ${strip.title}`}
              className="light"
              data-colour={strip.colour}
              title={strip.title}
              style={{
                top: ROW_PX * (row + 1),
                left: share(seconds(strip.first)),
                width: across(seconds(strip.last - strip.first)),
              }}
            />
          )),
        )}
        {violations.map((violation, place) => {
          const { first, risk_perceived: risk, avoidable_until: until } = violation;
          if (first === null) return null;
          const row = Math.max(
            egos.findIndex(({ id }) => id === violation.ego),
            0,
          );
          const top = ROW_PX * (row + 1);
          const time = seats[place] ?? seconds(first);
          return (
            <Fragment key={violation.number}>
              {risk !== null && (
                <span
                  className="risk"
                  data-tone={toneOf(violation)}
                  title={`${oracleName(violation.oracle)}: a careful driver perceives the risk from ${seconds(risk).toFixed(2)} s on`}
                  style={{ top, left: share(seconds(risk)), width: across(seconds(first - risk)) }}
                />
              )}
              {until !== null && inside(seconds(until)) && (
                <button
                  type="button"
                  className="until"
                  style={{ top, left: share(seconds(until)) }}
                  title={untilWords(violation, seconds(until))}
                  data-avoidable={violation.avoidable}
                  data-tone={toneOf(violation)}
                  onClick={() => clock.toStep(until)}
                >
                  ⟩
                </button>
              )}
              {inside(seconds(first)) && time < seconds(first) && (
                <span
                  className="moved"
                  data-tone={toneOf(violation)}
                  style={{ top, left: share(time), width: across(seconds(first) - time) }}
                />
              )}
              {inside(seconds(first)) && (
                <button
                  type="button"
                  className="verdict"
                  data-tone={toneOf(violation)}
                  style={{ top, left: share(time) }}
                  title={`${oracleName(violation.oracle)} at ${seconds(first).toFixed(2)} s: ${violation.message}`}
                  onClick={() => clock.toStep(first)}
                >
                  {violation.number}
                </button>
              )}
            </Fragment>
          );
        })}
        <div
          ref={cursor}
          className="cursor"
          role="slider"
          tabIndex={0}
          aria-label="Time"
          aria-valuemin={0}
          aria-valuemax={clock.end}
          aria-valuenow={Number(clock.time.toFixed(2))}
        />
      </div>
      <p className="legend">
        {violations.length > 0 && (
          <span>
            <i className="verdict" /> violation, with its number on the map
          </span>
        )}
        {withRisk && (
          <span>
            <i className="risk" data-tone={toneOf(withRisk)} /> a careful driver perceives the risk
          </span>
        )}
        {withUntil && (
          <span>
            <i className="until" data-tone={toneOf(withUntil)} data-avoidable={withUntil.avoidable}>
              ⟩
            </i>{" "}
            last moment to avoid it
          </span>
        )}
        {timeline && violations.length === 0 && <span>No violation. A click goes to a time.</span>}
      </p>
    </div>
  );
}
