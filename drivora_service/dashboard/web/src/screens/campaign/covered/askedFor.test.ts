import { expect, it } from "vitest";
import { askedFor } from "./askedFor";

it("a running campaign's values are asked for after its first simulation and each 25", () => {
  const running = [0, 1, 24, 25, 49, 50].map((simulations) =>
    askedFor({ state: "running", simulations }),
  );
  expect(running).toEqual([0, 1, 1, 25, 25, 50]);
  expect(askedFor({ state: "finished", simulations: 49 })).toBe(49);
});
