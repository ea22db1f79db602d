import { describe, expect, it } from "vitest";
import { readState, replayUpTo } from "./address";

describe("the address of a replay", () => {
  it.each([
    [12.5, 8.5],
    [4, 0],
    [1.2, 0],
    [null, 0],
    [undefined, 0],
  ])("a failure at %s is shown from %s on", (time, begin) => {
    expect(readState({ ...replayUpTo(time) }).time).toBe(begin);
  });
});
