import { describe, expect, it } from "vitest";
import { differenceOf, firstParting, partingWords, timesOfOther } from "./difference";
import type { Actor } from "./recording";

/** A run of one ego along x, and a walker that stands. */
function run(xs: readonly number[], walker = "walker") {
  const actor = (row: number, id: string): Actor => ({
    row,
    id,
    role: row ? "npc_walker" : "ego",
    model: "m",
    length: 4,
    width: 2,
  });
  return {
    actors: [actor(0, "ego"), actor(1, walker)],
    egos: 1,
    steps: xs.length,
    loaded: xs.length,
    stepLength: 0.1,
    x: Float32Array.from(xs.flatMap((x) => [x, 50])),
    y: new Float32Array(2 * xs.length),
    speed: Float32Array.from(xs.flatMap((x, k) => [(x - (xs[k - 1] ?? x)) * 10, 0])),
    routeS: Float32Array.from(xs),
  };
}

describe("two runs", () => {
  it("part where the first actor is elsewhere", () => {
    expect(firstParting(run([0, 1, 2, 3]), run([0, 1, 2.5, 3]))).toEqual({
      step: 2,
      time: 0.2,
      actor: "ego",
    });
  });
  it("are the same within a centimetre", () => {
    expect(firstParting(run([0, 1, 2]), run([0, 1.005, 2]))).toBeUndefined();
  });
  it("part where an actor is in one of them only, whichever it is", () => {
    const one = run([0, 1, 2]);
    const renamed = firstParting(one, run([0, 1, 2], "another"));
    expect(renamed).toMatchObject({ step: 0, actor: "walker", only: "first", atOtherTime: false });
    const fewer = { ...one, actors: one.actors.slice(0, 1), x: Float32Array.of(0, 1, 2) };
    const alone = { ...fewer, y: new Float32Array(3), speed: new Float32Array(3) };
    expect(firstParting(alone, one)).toMatchObject({ step: 0, actor: "walker", only: "second" });
    expect(firstParting(one, alone)).toMatchObject({ step: 0, actor: "walker", only: "first" });
  });
  it("part where an actor that only one has appears, and not before", () => {
    const late = run([0, 1, 2], "another");
    const one = run([0, 1, 2]);
    const absent = [Number.NaN, 50, 50];
    absent.forEach((x, step) => {
      late.x[2 * step + 1] = x;
      one.x[2 * step + 1] = Number.NaN;
    });
    expect(firstParting(one, late)).toMatchObject({ step: 1, actor: "another", only: "second" });
  });
  it("part where an actor of both appears later in one", () => {
    const late = run([0, 1, 2]);
    late.x[1] = Number.NaN;
    expect(firstParting(run([0, 1, 2]), late)).toEqual({
      step: 0,
      time: 0,
      actor: "walker",
      only: "first",
      atOtherTime: true,
    });
  });
  it("part where only one goes on", () => {
    expect(firstParting(run([0, 1, 2]), run([0, 1]))).toMatchObject({
      step: 2,
      actor: "",
      only: "first",
    });
    expect(firstParting(run([0, 1]), run([0, 1, 2]))).toMatchObject({ step: 2, only: "second" });
  });
  it("with steps of other lengths are compared at the same times", () => {
    const finer = { ...run([0, 0.5, 1, 1.5, 2]), stepLength: 0.05 };
    expect(firstParting(run([0, 1, 2]), finer)).toBeUndefined();
    expect(firstParting(finer, run([0, 1, 2]))).toBeUndefined();
  });
  it.each([
    [{ actor: "ego" }, "They part at 1.50 s: ego is elsewhere"],
    [{ actor: "van", only: "first" }, "They part at 1.50 s: only this run has van"],
    [
      { actor: "van", only: "second", atOtherTime: true },
      "They part at 1.50 s: only the other run has van at that time",
    ],
    [{ actor: "", only: "second" }, "They part at 1.50 s: only the other run goes on"],
  ] as const)("part in words: %o", (parting, words) => {
    expect(partingWords({ step: 15, time: 1.5, ...parting })).toBe(words);
  });
  it("are in step by time, the shorter one standing at its end", () => {
    const times = timesOfOther(run([0, 1, 2, 3]), run([0, 2]), 0, 0, "time");
    expect([...times]).toEqual([0, 0.1, 0.1, 0.1]);
  });
  it("are in step by distance along the route", () => {
    const times = timesOfOther(run([0, 2, 4]), run([0, 1, 2, 3, 4]), 0, 0, "route");
    expect(times[1]).toBeCloseTo(0.2);
    expect(times[2]).toBeCloseTo(0.4);
  });
  it("on one path at different speeds are together in step by distance", () => {
    const one = run(Array.from({ length: 76 }, (_, k) => 1.3 * k));
    const other = run(Array.from({ length: 140 }, (_, k) => 0.7 * k + 0.0005 * k * k));
    const times = timesOfOther(one, other, 0, 0, "route");
    const { apart, speed } = differenceOf(one, other, 0, 0, times);
    expect(Math.max(...apart)).toBeLessThan(0.001);
    // Neither the distance nor the difference of speed has teeth.
    expect(speed[2]).toBeGreaterThan(speed[3] as number);
    expect(speed[3]).toBeGreaterThan(speed[4] as number);
  });
  it("are in step by distance up to where the other ended, though it stands there on", () => {
    const other = run([0, 1, 2, 2, 2]);
    other.routeS.fill(Number.NaN, 3);
    const one = run([0, 1, 2, 3, 4]);
    const times = timesOfOther(one, other, 0, 0, "route");
    expect([...times].map((time) => Number(time.toFixed(3)))).toEqual([0, 0.1, 0.2, 0.2, 0.2]);
    const { apart } = differenceOf(one, other, 0, 0, times);
    expect([...apart]).toEqual([0, 0, 0, Number.NaN, Number.NaN]);
  });
  it("that roll back do not turn the time of the other back", () => {
    const times = timesOfOther(run([0, 2, 1.5, 3]), run([0, 1, 2, 3]), 0, 0, "route");
    expect([...times].map((time) => Number(time.toFixed(3)))).toEqual([0, 0.2, 0.2, 0.3]);
  });
  it("have no distance where one of them is over", () => {
    const one = run([0, 1, 2, 3]);
    const other = run([0, 2]);
    const times = timesOfOther(one, other, 0, 0, "time");
    const { apart, speed } = differenceOf(one, other, 0, 0, times);
    expect([...apart]).toEqual([0, 1, Number.NaN, Number.NaN]);
    expect([...speed].slice(2)).toEqual([Number.NaN, Number.NaN]);
  });
  it("have a distance and a difference of speed", () => {
    const one = run([0, 2, 4]);
    const other = run([0, 1, 2]);
    const times = timesOfOther(one, other, 0, 0, "time");
    const { apart, speed } = differenceOf(one, other, 0, 0, times);
    expect([...apart]).toEqual([0, 1, 2]);
    expect(speed[2]).toBeCloseTo(10);
  });
});
