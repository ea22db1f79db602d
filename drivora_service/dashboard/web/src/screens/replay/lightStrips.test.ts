import { expect, it } from "vitest";
import { stripsOf } from "./lightStrips";

it("a signal is shown while it is the next one of the ego", () => {
  const timeline = {
    run_id: "r",
    network: "n",
    steps: 200,
    step_length: 0.1,
    duration: 19.9,
    egos: [],
    actors: [],
    violations: [],
    log: [],
    log_lines: 0,
    lights: [
      {
        id: "a",
        link: 3,
        lane: "l",
        approaches: [
          { ego: 0, first: 20, last: 80, passed: 79 },
          { ego: 1, first: 0, last: 10, passed: null },
        ],
        phases: [
          { light: "red", first: 0, last: 49 },
          { light: "green", first: 50, last: 199 },
        ],
      },
    ],
  };
  const strips = stripsOf(timeline, 0, 0.1);
  expect(strips.map(({ first, last, colour }) => [first, last, colour])).toEqual([
    [20, 50, "red"],
    [50, 81, "green"],
  ]);
  expect(strips[0]?.title).toBe("Signal 3 of a: red from 0.00 s to 5.00 s");
});
