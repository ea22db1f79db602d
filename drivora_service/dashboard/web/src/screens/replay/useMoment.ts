import { useEffect, useState } from "react";
import type { Clock } from "./clock";

const PANEL_MS = 100;

/** The step that panels show: while a replay plays, ten times a second. */
export function useStep(clock: Clock): number {
  const [step, setStep] = useState(clock.step);
  useEffect(() => {
    let shownAt = 0;
    const show = () => {
      const now = performance.now();
      if (clock.playing && now - shownAt < PANEL_MS) return;
      shownAt = now;
      setStep(clock.step);
    };
    show();
    return clock.listen(show);
  }, [clock]);
  return step;
}

/** Whether a replay plays, and how fast. */
export function usePlaying(clock: Clock): { readonly playing: boolean; readonly rate: number } {
  const [state, setState] = useState({ playing: clock.playing, rate: clock.rate });
  useEffect(() => {
    const show = () =>
      setState((before) =>
        before.playing === clock.playing && before.rate === clock.rate
          ? before
          : { playing: clock.playing, rate: clock.rate },
      );
    show();
    return clock.listen(show);
  }, [clock]);
  return state;
}
