import { describe, expect, it } from "vitest";
import { classesOf, classOf, classText } from "./countClasses";

const all = (most: number) => Array.from({ length: most + 1 }, (_, count) => count);

describe("classes of counts", () => {
  it("are the counts themselves where these are few", () => {
    const classes = classesOf([0, 48, 24, 24]);
    expect(classes.map(classText)).toEqual(["24", "48"]);
    expect(classes.map(({ shade }) => shade)).toEqual([1, 5]);
    expect(classesOf([7])).toEqual([{ from: 7, to: 7, shade: 3 }]);
  });
  it("are cut at equal factors, at round counts", () => {
    const classes = classesOf(all(443));
    expect(classes.map(classText)).toEqual(["1–2", "3–6", "7–19", "20–49", "50–149", "150–443"]);
    expect(classes.map(({ shade }) => shade)).toEqual([0, 1, 2, 3, 4, 5]);
  });
  it("leave no count out and no class empty", () => {
    for (const most of [7, 9, 12, 30, 1000, 123456]) {
      const classes = classesOf(all(most));
      expect(classes[0]?.from).toBe(1);
      expect(classes.at(-1)?.to).toBe(most);
      for (const [place, { from, to }] of classes.entries()) {
        expect(to).toBeGreaterThanOrEqual(from);
        expect(classes[place + 1]?.from ?? to + 1).toBe(to + 1);
      }
    }
  });
  it("have a class for each count but 0", () => {
    const classes = classesOf(all(443));
    expect(classOf(classes, 0)).toBeUndefined();
    expect(classOf(classes, 19)?.from).toBe(7);
    expect(classOf(classes, 20)?.from).toBe(20);
    expect(classesOf([0])).toEqual([]);
  });
});
