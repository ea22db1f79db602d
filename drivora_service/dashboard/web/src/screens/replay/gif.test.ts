import { expect, it } from "vitest";
import { gifTimes } from "./gif";

it("frames of a GIF are a tenth of a second apart at the speed of the replay", () => {
  expect(gifTimes({ from: 2, to: 2.5 }, 1)).toHaveLength(6);
  expect(gifTimes({ from: 2, to: 2.5 }, 0.5)).toHaveLength(11);
  const times = gifTimes({ from: 2, to: 4 }, 2);
  expect(times[0]).toBe(2);
  expect(times.at(-1)).toBeCloseTo(4);
});

it("a stretch of too many frames is refused with the way out", () => {
  expect(() => gifTimes({ from: 0, to: 200 }, 1)).toThrow("shorter one");
  expect(gifTimes({ from: 0, to: 200 }, 5)).toHaveLength(401);
});
