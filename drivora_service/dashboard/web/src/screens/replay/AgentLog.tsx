import { useEffect, useRef } from "react";
import type { Clock } from "./clock";
import type { Recording } from "./recording";
import { useStep } from "./useMoment";

const MOST = 200;

/** The lines of an agent's log up to the time; the newest is in sight. */
export function AgentLog({
  recording,
  clock,
  ego,
}: {
  readonly recording: Recording;
  readonly clock: Clock;
  readonly ego: number;
}) {
  const step = useStep(clock);
  const end = useRef<HTMLDivElement>(null);
  const lines = recording.log.filter((line) => line.ego === ego && line.step <= step).slice(-MOST);
  const count = lines.length;
  // biome-ignore lint/correctness/useExhaustiveDependencies: each new line comes into sight
  useEffect(() => {
    // In braces: newer browsers return a promise, which React would call as what undoes the effect.
    end.current?.scrollTo({ top: end.current.scrollHeight });
  }, [count]);
  return (
    <section className="panel log" aria-label="Log of the agent">
      <header>
        <h2>Log</h2>
      </header>
      <div ref={end} className="lines">
        {count === 0 && <p className="quiet">No line yet.</p>}
        {lines.map((line, place) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: lines are only added
          <button key={place} type="button" onClick={() => clock.toStep(line.step)}>
            <span className="quiet">{(line.step * recording.stepLength).toFixed(2)}</span>
            {line.message}
          </button>
        ))}
      </div>
    </section>
  );
}
