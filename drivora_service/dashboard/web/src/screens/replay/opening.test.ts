import { describe, expect, it } from "vitest";
import type { Schemas } from "../../api/client";
import { cameraOf } from "../../roads/camera";
import { focusOf, openingBox, type Ways, wholeBox } from "./opening";
import type { Actor } from "./recording";

const SIZE = { width: 1000, height: 470 };
const STEP_S = 0.5;

/** Actors that drive east at constant speeds from places, for a number of steps. */
function driven(
  steps: number,
  egos: number,
  actors: readonly { readonly x: number; readonly y: number; readonly speed: number }[],
): Ways {
  const cells = Array.from({ length: steps }).flatMap((_, step) =>
    actors.map(({ x, y, speed }) => [x + speed * step * STEP_S, y] as const),
  );
  return {
    x: Float32Array.from(cells, ([x]) => x),
    y: Float32Array.from(cells, ([, y]) => y),
    stepLength: STEP_S,
    loaded: steps,
    egos,
    actors: actors as unknown as readonly Actor[],
  };
}

const scaleOf = (ways: Ways, from = 0, focus = 0) =>
  cameraOf(openingBox(ways, SIZE, from, focus), SIZE).scale;

describe("what a map shows when a replay opens", () => {
  it("is the whole of a short run", () => {
    const ways = driven(21, 1, [{ x: 0, y: 0, speed: 10 }]);
    expect(openingBox(ways, SIZE, 4, 0)).toEqual(wholeBox(ways));
    expect(wholeBox(ways)).toEqual([-12, -22, 112, 22]);
  });
  it("has the way of an actor that comes near, and not that of others", () => {
    const near = { x: 60, y: 5, speed: -5 };
    const far = { x: 0, y: 300, speed: 0 };
    const ways = driven(11, 1, [{ x: 0, y: 0, speed: 5 }, near, far]);
    expect(openingBox(ways, SIZE, 0, 0)).toEqual([-12, -19.5, 72, 24.5]);
  });
  it("is the next seconds of a long run, so that cars are not specks", () => {
    const ways = driven(201, 1, [{ x: 0, y: 0, speed: 14 }]);
    const box = openingBox(ways, SIZE, 20, 0);
    expect(box[0]).toBe(280 - 12);
    expect(box[2]).toBe(280 + 140 + 12);
    expect(scaleOf(ways, 20)).toBeGreaterThan(5);
    expect(cameraOf(wholeBox(ways), SIZE).scale).toBeLessThan(1);
  });
  it("is one ego where several are far apart", () => {
    const ways = driven(201, 2, [
      { x: 0, y: 0, speed: 10 },
      { x: 0, y: 400, speed: 10 },
    ]);
    expect(openingBox(ways, SIZE, 0, 1)).toEqual([-12, 378, 112, 422]);
  });
  it("is not nearer than the surroundings of an actor that stands", () => {
    const ways = driven(11, 1, [{ x: 7, y: 3, speed: 0 }]);
    expect(openingBox(ways, SIZE, 0, 0)).toEqual([-15, -19, 29, 25]);
  });
  it("is legible at the speed of a motorway, too", () => {
    expect(scaleOf(driven(101, 1, [{ x: 0, y: 0, speed: 33 }]))).toBeGreaterThan(5);
  });
  it("is where an ego was, if it is gone at the opening moment", () => {
    const ways = driven(201, 1, [{ x: 0, y: 0, speed: 14 }]);
    ways.x.fill(Number.NaN, 100);
    expect(openingBox(ways, SIZE, 90, 0)).toEqual(wholeBox(ways));
  });
});

describe("the ego that is kept in sight", () => {
  const actors = [{ id: "a" }, { id: "b" }];
  const found = (ego: string, severity: "major" | "observation") =>
    ({
      oracle: "collision",
      ego,
      outcome: "violated",
      severity,
      at_fault: true,
      follows: "",
    }) as Schemas["Verdict"];
  const of = (...verdicts: Schemas["Verdict"][]) => ({ verdicts, failing_verdicts: [] });
  it("is the chosen one", () => {
    expect(focusOf(actors, of(found("a", "major")), "b")).toBe(1);
  });
  it("is that of the gravest violation", () => {
    expect(focusOf(actors, of(found("a", "observation"), found("b", "major")), "")).toBe(1);
  });
  it("is the first where nothing was violated", () => {
    expect(focusOf(actors, of(found("b", "observation")), "")).toBe(0);
  });
});
