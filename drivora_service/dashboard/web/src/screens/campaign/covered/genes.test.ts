import { describe, expect, it } from "vitest";
import { binRange, binText, familiesOf, rangeText, triedOf } from "./genes";

function gene(block: string, name: string, high = 10, simulations = [1, 0]) {
  const none = simulations.map(() => 0);
  const counts = { simulations, failing: none, avoidable: none };
  return {
    seed_number: 0,
    block,
    name,
    unit: "m/s",
    kind: "continuous",
    low: 0,
    high,
    ...counts,
  } as const;
}
const whole = (kind: "integer" | "category", low: number, high: number, bins: number) => ({
  ...gene("vehicle_0", "path", high, Array<number>(bins).fill(0)),
  kind,
  low,
  unit: "",
});

describe("genes", () => {
  it("are rows of the parts of a scenario, with a cell for each block", () => {
    const families = familiesOf([
      gene("vehicle_0", "start"),
      gene("vehicle_0", "speed_0", 10, [3, 7]),
      gene("vehicle_1", "speed_0"),
      gene("vehicle_1", "start", 20),
      gene("weather", "fog"),
    ]);
    expect(families.map(({ name, blocks }) => [name, blocks])).toEqual([
      ["vehicle", ["vehicle_0", "vehicle_1"]],
      ["weather", ["weather"]],
    ]);
    const cells = families[0]?.rows.map(({ name, high, most, cells }) => [
      name,
      high,
      most,
      cells.map((cell) => cell !== undefined),
    ]);
    expect(cells).toEqual([
      ["start", 10, 1, [true, false]],
      ["speed_0", 10, 7, [true, true]],
      ["start", 20, 1, [false, true]],
    ]);
  });
  it("have bins of equal width, or of whole numbers", () => {
    const continuous = gene("a", "b", 10, [0, 0, 0, 0]);
    expect([binRange(continuous, 0), binRange(continuous, 3)]).toEqual([
      [0, 2.5],
      [7.5, 10],
    ]);
    const lanes = whole("integer", -1, 1, 3);
    expect([0, 1, 2].map((bin) => binRange(lanes, bin))).toEqual([
      [-1, -1],
      [0, 0],
      [1, 1],
    ]);
  });
  it("put each of many whole numbers into the bin in which the service counts it", () => {
    for (const [values, bins] of [
      [27, 20],
      [30, 20],
      [50, 20],
      [34, 20],
      [40, 20],
      [41, 20],
      [12, 12],
    ] as const) {
      const many = whole("category", 0, values - 1, bins);
      for (let value = 0; value < values; value++) {
        const bin = Math.floor(((value + 0.5) / values) * bins);
        const [from, to] = binRange(many, bin);
        expect(value >= from && value <= to, `${value} of ${values} in ${from} to ${to}`).toBe(
          true,
        );
      }
    }
  });
  it("are told in words", () => {
    expect(binText(gene("a", "b", 10), 1)).toBe("5 to 10 m/s");
    expect(binText(whole("integer", -1, 1, 3), 0)).toBe("−1");
    expect(binText(whole("category", 0, 6, 7), 4)).toBe("category 4");
    expect(binText(whole("category", 0, 26, 20), 1)).toBe("categories 1 to 2");
    expect(rangeText(whole("category", 0, 6, 7))).toBe("7 categories");
    expect(rangeText(gene("a", "b", 43.329))).toBe("0 to 43.33");
  });
  it("tell how many bins were tried", () => {
    expect(triedOf([gene("a", "b"), gene("a", "c", 1, [0, 2, 9])])).toEqual({ tried: 3, bins: 5 });
  });
});
