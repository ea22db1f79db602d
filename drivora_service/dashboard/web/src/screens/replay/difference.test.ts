import { describe, expect, it } from "vitest";
import { differenceOf, firstParting, timesOfOther } from "./difference";
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
  it("are the same within a centimetre, and where actors have other names", () => {
    expect(firstParting(run([0, 1, 2]), run([0, 1.005, 2]))).toBeUndefined();
    expect(firstParting(run([0, 1, 2]), run([0, 1, 2], "another"))).toBeUndefined();
  });
  it("part where only one goes on", () => {
    expect(firstParting(run([0, 1, 2]), run([0, 1]))).toMatchObject({ step: 2, actor: "" });
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
