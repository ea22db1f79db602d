import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Clock } from "./clock";

describe("the clock of a replay", () => {
  let waiting: FrameRequestCallback[] = [];
  let now = 0;
  beforeEach(() => {
    waiting = [];
    now = 0;
    vi.stubGlobal("requestAnimationFrame", (call: FrameRequestCallback) => waiting.push(call));
    vi.stubGlobal("cancelAnimationFrame", () => {
      waiting = [];
    });
    vi.spyOn(performance, "now").mockImplementation(() => now);
  });
  afterEach(() => vi.unstubAllGlobals());
  const pass = (ms: number) => {
    now += ms;
    const calls = waiting;
    waiting = [];
    for (const call of calls) call(now);
  };

  it("stops before the end where it is told to", () => {
    const clock = new Clock(10, 0.05);
    clock.until = 2;
    clock.play();
    pass(60_000);
    expect([clock.time, clock.playing]).toEqual([2, false]);
  });
  it("goes by its rate and stops at the end", () => {
    const clock = new Clock(10, 0.05);
    clock.setRate(2);
    clock.play();
    pass(1500);
    expect(clock.time).toBeCloseTo(3);
    pass(60_000);
    expect(clock.time).toBe(10);
    expect(clock.playing).toBe(false);
    expect(waiting).toHaveLength(0);
  });
  it("begins anew when it is played at its end", () => {
    const clock = new Clock(10, 0.05);
    clock.seek(10);
    clock.play();
    expect(clock.time).toBe(0);
  });
  it("asks for no frame while it stands", () => {
    const clock = new Clock(10, 0.05);
    clock.seek(3);
    expect(waiting).toHaveLength(0);
  });
  it("knows the step of a time that is no exact sum", () => {
    const clock = new Clock(10, 0.05);
    for (const step of [0, 3, 6, 7, 199, 200]) {
      clock.toStep(step);
      expect(clock.step).toBe(step);
    }
    expect(clock.lastStep).toBe(200);
  });
  it("changes its rate between a tenth and ten", () => {
    const clock = new Clock(10, 0.05);
    for (let k = 0; k < 9; k++) clock.changeRate(1);
    expect(clock.rate).toBe(10);
    for (let k = 0; k < 9; k++) clock.changeRate(-1);
    expect(clock.rate).toBe(0.1);
  });
});
