import { describe, expect, it } from "vitest";
import { readState, replayUpTo, stretchWords } from "./address";

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
  it("has the stretch of the time line in two decimals, unless it is the whole run", () => {
    const words = stretchWords({ from: 2.71499, to: 8 }, 20);
    expect(words).toEqual({ from: "2.71", to: "8.00" });
    expect(readState(words).stretch).toEqual({ from: 2.71, to: 8 });
    expect(readState(words).time).toBe(2.71);
    expect(readState({ ...words, t: "5" }).time).toBe(5);
    expect(stretchWords({ from: 0, to: 20 }, 20)).toEqual({ from: undefined, to: undefined });
  });
  it.each([
    [{}],
    [{ from: "3" }],
    [{ to: "3" }],
    [{ from: "8", to: "3" }],
    [{ from: "a", to: "3" }],
    [{ from: "1", to: "Infinity" }],
  ])("with %o shows the whole run", (search) => {
    expect(readState(search).stretch).toBeUndefined();
  });
  it("has the chosen ego, none for the first", () => {
    expect(readState({ ego: "ego_1" }).ego).toBe("ego_1");
    expect(readState({}).ego).toBe("");
  });
});
