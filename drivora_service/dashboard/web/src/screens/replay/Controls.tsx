import { type ReactNode, useEffect, useRef } from "react";
import type { Clock } from "./clock";
import { RATES } from "./clock";
import { usePlaying } from "./useMoment";
import "./controls.css";

/** Play, pause, steps, speed, and the time in numbers. */
export function Controls({
  clock,
  children,
}: {
  readonly clock: Clock;
  readonly children?: ReactNode;
}) {
  const { playing, rate } = usePlaying(clock);
  const shown = useRef<HTMLOutputElement>(null);
  useEffect(() => {
    // Written past React: it changes with every frame.
    const show = () => {
      if (shown.current)
        shown.current.textContent = `${clock.time.toFixed(2)} s · step ${clock.step}`;
    };
    show();
    return clock.listen(show);
  }, [clock]);
  return (
    <div className="controls whole-width">
      <button
        type="button"
        onClick={() => clock.toStep(clock.step - 1)}
        aria-label="One step back"
        title="One step back (←)"
      >
        ‹
      </button>
      <button
        type="button"
        className="primary play"
        onClick={() => clock.toggle()}
        title="Play or pause (space)"
      >
        {playing ? "Pause" : "Play"}
      </button>
      <button
        type="button"
        onClick={() => clock.toStep(clock.step + 1)}
        aria-label="One step ahead"
        title="One step ahead (→)"
      >
        ›
      </button>
      <label>
        <span className="hidden-visually">Speed</span>
        <select
          value={rate}
          onChange={(event) => clock.setRate(Number(event.target.value))}
          title="Speed (< and >)"
        >
          {RATES.map((value) => (
            <option key={value} value={value}>
              {value}×
            </option>
          ))}
        </select>
      </label>
      <output ref={shown} className="time" aria-live="off" />
      <span className="quiet">of {clock.end.toFixed(2)} s</span>
      {children}
    </div>
  );
}
