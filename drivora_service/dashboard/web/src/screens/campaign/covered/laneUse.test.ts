import { describe, expect, it } from "vitest";
import { pieceAt, piecesOf, runsOf, usedBounds } from "./laneUse";

const CORNER = [0, 0, 10, 0, 10, 10];
const used = (count: number) => (count > 0 ? count : undefined);

describe("the use of a lane", () => {
  it("is drawn as runs of alike pieces, without the unused ones", () => {
    expect(runsOf(CORNER, [3, 3, 0, 5], used)).toEqual([
      { shade: 3, line: [0, 0, 10, 0] },
      { shade: 5, line: [10, 5, 10, 10] },
    ]);
    expect(runsOf(CORNER, [1, 2, 2, 0], used)).toEqual([
      { shade: 1, line: [0, 0, 5, 0] },
      { shade: 2, line: [5, 0, 10, 0, 10, 5] },
    ]);
    expect(runsOf(CORNER, [0, 0], used)).toEqual([]);
  });
  it("is told piece by piece", () => {
    expect(piecesOf({ lane: "a", egos: [0, 2], actors: [1, 4] }, 9)).toEqual([
      { place: 0, from: 0, to: 4.5, egos: 0, actors: 1 },
      { place: 1, from: 4.5, to: 9, egos: 2, actors: 4 },
    ]);
  });
  it("is found by a distance along the lane, at its ends as well", () => {
    const lane = { lane: "a", egos: [0, 2], actors: [1, 4] };
    const at = (along: number) => pieceAt(lane, 9, along)?.place;
    expect([0, 4.4, 4.5, 9, 9.0001].map(at)).toEqual([0, 0, 1, 1, 1]);
  });
  it("has bounds with room, of the used pieces and other places alone", () => {
    const lanes = [{ lane: "a", egos: [1, 0], actors: [1, 1] }];
    const lineOf = (lane: string) => (lane === "a" ? CORNER : undefined);
    expect(usedBounds(lanes, "egos", lineOf, [], 0.5)).toEqual([-12, -12, 22, 12]);
    expect(usedBounds(lanes, "actors", lineOf, [], 0.5)).toEqual([-12, -12, 22, 22]);
    expect(usedBounds(lanes, "egos", lineOf, [[5, 40]], 0.5)).toEqual([-20, -20, 30, 60]);
    expect(usedBounds([], "egos", lineOf, [], 0.5)).toBeUndefined();
  });
});
