import { readFileSync } from "node:fs";
import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, expect, inject, it } from "vitest";
import { startBrowser } from "./support/browser";
import { open } from "./support/page";

const url = inject("url");
const made = inject("made");
let browser: Browser;

beforeAll(async () => {
  browser = await startBrowser();
});
afterAll(() => browser.close());

/** Waits for the replay of a run, and returns the step at which it stands. */
async function stepOf(page: Page): Promise<number> {
  const told = await page.locator(".controls .time").innerText();
  return Number(/step (\d+)/.exec(told)?.[1]);
}

/** Returns what the browser decodes of a GIF: the number of frames, and how many differ. */
const DECODE = `async (base64) => {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const decoder = new ImageDecoder({ data: bytes, type: "image/gif" });
  await decoder.tracks.ready;
  await decoder.completed;
  const { frameCount } = decoder.tracks.selectedTrack;
  const seen = new Set();
  let size = "";
  for (let k = 0; k < frameCount; k++) {
    const { image } = await decoder.decode({ frameIndex: k });
    const sheet = new OffscreenCanvas(image.displayWidth, image.displayHeight);
    const pen = sheet.getContext("2d");
    pen.drawImage(image, 0, 0);
    const { data } = pen.getImageData(0, 0, sheet.width, sheet.height);
    seen.add(new TextDecoder("latin1").decode(await crypto.subtle.digest("SHA-256", data)));
    size = image.displayWidth + " x " + image.displayHeight;
  }
  return { frames: frameCount, different: seen.size, size };
}`;

it("a stretch is saved as a GIF while the page answers, and can be given up", async () => {
  const { page, context, complaints } = await open(browser, `${url}/runs/${made.run}`);
  const save = page.getByRole("button", { name: "GIF" });
  await save.click();
  const cancel = page.getByRole("button", { name: "Cancel" });
  await cancel.click();
  await save.waitFor();
  const coming = page.waitForEvent("download");
  await save.click();
  await page.getByRole("progressbar", { name: "Saving the GIF" }).waitFor();
  const file = await (await coming).path();
  const content = readFileSync(file);
  const decoded = (await page.evaluate(
    `(${DECODE})(${JSON.stringify(content.toString("base64"))})`,
  )) as { frames: number; different: number; size: string };
  const end = Number(/of ([\d.]+) s/.exec(await page.locator(".controls").innerText())?.[1]);
  expect(decoded.frames).toBe(Math.floor(end * 10 + 1e-6) + 1);
  // The time in the foot of each frame is its own.
  expect(decoded.different).toBe(decoded.frames);
  expect(decoded.size).toMatch(/^720 x /);
  await save.waitFor();
  expect(await stepOf(page)).toBe(0);
  expect(complaints).toEqual([]);
  await context.close();
});
