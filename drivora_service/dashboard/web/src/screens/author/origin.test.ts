import { expect, it } from "vitest";
import { originWords, readOrigin } from "./origin";

it("an edited scenario is named after what it was opened from", () => {
  const origin = { label: "ego-turns-left-before-oncoming", run: "7" };
  expect(originWords(origin, false)).toBe("ego-turns-left-before-oncoming");
  expect(originWords(origin, true)).toBe("ego-turns-left-before-oncoming, edited");
});

it("what was edited twice is called so once, and a name has at most 100 characters", () => {
  expect(originWords({ label: "cut in, edited", run: "" }, true)).toBe("cut in, edited");
  const long = originWords({ label: "x".repeat(200), run: "" }, true);
  expect(long).toHaveLength(100);
  expect(long).toMatch(/x, edited$/);
});

it("anything may have been stored", () => {
  expect(readOrigin({ label: "cut in", run: "7" })).toEqual({ label: "cut in", run: "7" });
  expect(readOrigin({ label: "cut in" })).toEqual({ label: "cut in", run: "" });
  for (const other of [undefined, null, 3, "cut in", { run: "7" }, { label: "" }])
    expect(readOrigin(other)).toBeUndefined();
});
