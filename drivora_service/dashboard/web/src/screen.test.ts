import { expect, it, vi } from "vitest";
import { ScreenNotLoaded, untilLoaded } from "./screen";

const failed = new TypeError("Failed to fetch dynamically imported module");

it("code that cannot be fetched is asked for again while the service does not answer", async () => {
  const load = vi.fn(() =>
    load.mock.calls.length < 4 ? Promise.reject(failed) : Promise.resolve("loaded"),
  );
  const waits: number[] = [];
  const wait = async (ms: number) => {
    waits.push(ms);
  };
  expect(await untilLoaded(load, async () => false, wait)()).toBe("loaded");
  expect(waits).toEqual([400, 800, 1600]);
});

it("code that is gone is an error if the service answers", async () => {
  const gone = untilLoaded(
    () => Promise.reject(failed),
    async () => true,
  );
  await expect(gone()).rejects.toBeInstanceOf(ScreenNotLoaded);
});
