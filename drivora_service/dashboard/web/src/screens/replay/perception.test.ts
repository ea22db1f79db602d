import { expect, it } from "vitest";
import { PerceivedActors } from "./perception";

it("an actor is perceived, missed with a reason, or not told of", () => {
  const head = {
    run_id: "r",
    ego: "ego",
    row: 0,
    privileged: false,
    sensor: {
      range: 50,
      position_noise: 0,
      speed_noise: 0,
      dropout: 0,
      latency_steps: 0,
      hides: true,
    },
    sights: ["absent", "perceived", "other_level", "out_of_range", "dropped", "hidden"],
  };
  const columns = new Map(
    Object.entries({
      step: [4, 4, 5],
      actor: [1, 2, 1],
      sight: [1, 5, 3],
      x: [10, Number.NaN, Number.NaN],
      y: [20, Number.NaN, Number.NaN],
      yaw: [0.5, Number.NaN, Number.NaN],
    }).map(([name, values]) => [name, Float64Array.from(values)]),
  );
  const seen = new PerceivedActors({ head, columns, rows: 3 }, 10, 3);
  expect(seen.isPerceived(4, 1)).toBe(true);
  expect(seen.x[4 * 3 + 1]).toBe(10);
  expect(seen.words(4, 2)).toBe("hidden");
  expect(seen.isMissed(5, 1)).toBe(true);
  expect(seen.words(5, 2)).toBe("");
  expect(seen.isMissed(5, 2)).toBe(false);
  expect(seen.counts(4)).toEqual([1, 2]);
});
