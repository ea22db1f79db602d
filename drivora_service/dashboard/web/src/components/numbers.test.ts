import { describe, expect, it } from "vitest";
import { count, duration, fixed } from "./numbers";

describe("numbers", () => {
  it("have separators and nothing where nothing was measured", () => {
    expect(count(1234567)).toBe("1,234,567");
    expect(count(null)).toBe("");
    expect(fixed(Number.NaN, 2)).toBe("");
    expect([fixed(-0.001, 2), fixed(-0.4, 0), fixed(-0.01, 2)]).toEqual(["0.00", "0", "-0.01"]);
  });
  it("give durations in two units", () => {
    expect(duration(59.4)).toBe("59 s");
    expect(duration(200)).toBe("3 min 20 s");
    expect(duration(3600)).toBe("1 h");
    expect(duration(7500)).toBe("2 h 5 min");
  });
});
