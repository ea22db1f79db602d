import { readFileSync } from "node:fs";
import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, expect, inject, it } from "vitest";
import { Api } from "./support/api";
import { startBrowser } from "./support/browser";
import { open } from "./support/page";

const url = inject("url");
const made = inject("made");
const api = new Api(url);
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
  // A software renderer takes half a minute on a busy machine.
  const coming = page.waitForEvent("download", { timeout: 100_000 });
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
}, 120_000);

/** Returns the metres of the scale bar of the map: fewer, the nearer. */
async function scaleBar(page: Page): Promise<number> {
  return Number.parseFloat(await page.locator(".scale-bar").first().innerText());
}

/** Returns the first run of a batch that is as wanted. */
async function runOf(batch: string, wanted: (run: Told) => boolean): Promise<Told> {
  const { items } = await api.get<{ items: Told[] }>(`/runs?batch=${batch}&limit=100`);
  const found = items.find(wanted);
  if (!found) throw new Error(`no run of batch ${batch} is as wanted`);
  return found;
}

interface Told {
  readonly id: string;
  readonly label: string;
  readonly town: string;
  readonly sim_time_s: number;
  readonly violations: number;
  readonly observations: number;
  readonly simulation_sha256?: string;
  readonly trace_sha256?: string;
}

it("a long replay opens where its ego is, goes with it, and shows the whole run by a key", async () => {
  // Of the examples the one whose egos drive through a whole town.
  const run = await runOf(made.batches[1] ?? "", ({ sim_time_s }) => sim_time_s > 90);
  const { page, context, complaints } = await open(browser, `${url}/runs/${run.id}`);
  await expect.poll(() => scaleBar(page), { timeout: 30_000 }).toBeLessThanOrEqual(20);
  const near = await scaleBar(page);
  expect(page.url()).not.toContain("camera=");
  await page.keyboard.press("End");
  expect(await scaleBar(page)).toBe(near);
  expect(page.url()).not.toContain("camera=");
  await page.keyboard.press("f");
  await expect.poll(() => scaleBar(page)).toBeGreaterThanOrEqual(50);
  await expect.poll(() => page.url()).toContain("camera=");
  // The camera of an address is shown as it is.
  await page.goto(`${url}/runs/${run.id}?camera=0,0,2`);
  await page.locator(".controls .time").waitFor();
  await expect.poll(() => scaleBar(page)).toBe(50);
  await page.keyboard.press("End");
  expect(await scaleBar(page)).toBe(50);
  expect(new URL(page.url()).searchParams.get("camera")).toBe("0,0,2");
  expect(complaints).toEqual([]);
  await context.close();
});

it("plots have the same height, and one without values is told instead of drawn", async () => {
  const { page, context } = await open(browser, `${url}/runs/${made.run}`);
  await page.getByText("Not drawn: Controls, as scripted drives without throttle").waitFor();
  expect(await page.getByRole("img", { name: /^Controls/ }).count()).toBe(0);
  const boxes = await Promise.all(
    (await page.locator(".plots .plot").all()).map((plot) => plot.boundingBox()),
  );
  expect(boxes.length).toBeGreaterThanOrEqual(3);
  const rows = new Set(boxes.map((box) => box?.y));
  expect(new Set(boxes.map((box) => box?.height)).size).toBe(1);
  // Plots beside one another begin at the same height.
  expect(rows.size).toBeLessThan(boxes.length);
  await context.close();
});

it("a run without a violation tells its observations in the same sentence", async () => {
  const run = await runOf(
    made.paired[1],
    ({ violations, observations }) => violations === 0 && observations > 0,
  );
  const { page, context } = await open(browser, `${url}/runs/${run.id}`);
  const line = page.locator(".verdict-line");
  await line.waitFor();
  const counted = run.observations === 1 ? "1 observation" : `${run.observations} observations`;
  expect((await line.innerText()).replaceAll(/\s+/g, " ")).toContain(
    `No oracle was violated; ${counted}: `,
  );
  await context.close();
});

it("a passed candidate of a campaign is run again from its page, recorded and the same", async () => {
  const { items } = await api.get<{ items: { number: number }[] }>(
    `/campaigns/${made.campaign}/evaluations?violating=false&status=judged&limit=1`,
  );
  const id = `${made.campaign}-${items[0]?.number}`;
  const { page, context, complaints } = await open(browser, `${url}/runs/${id}`);
  await page.getByText(`drivora replay ${id}`).waitFor();
  await page.getByRole("button", { name: "Run it again here" }).click();
  await page.waitForURL((address) => !address.pathname.endsWith(id));
  const again = new URL(page.url()).pathname.split("/").at(-1);
  await page.locator(".controls .time").waitFor({ timeout: 120_000 });
  const [before, after] = await Promise.all(
    [id, again].map((run) => api.get<Told>(`/runs/${run}`)),
  );
  expect(after?.label).toBe(`replay of ${id}`);
  expect(after?.simulation_sha256).toBe(before?.simulation_sha256);

  // Either leads to the other; the first offers its replay before another run.
  await page.getByRole("link", { name: "the run that it repeats" }).click();
  await page.getByText("Its replays:").waitFor();
  await page.getByRole("link", { name: `replay of ${id}` }).click();
  await page.waitForURL(({ pathname }) => pathname === `/runs/${again}`);
  await page.locator(".controls .time").waitFor();

  // A run that has no recording cannot be compared with, and another is found by its id.
  await page.getByText("Compare…").click();
  const find = page.getByRole("searchbox", { name: "Find a run to compare with" });
  await find.fill(id);
  await page.getByText("That run has no recording").waitFor();
  const listed = await api.get<{ items: Told[] }>(
    `/runs?town=${after?.town}&status=finished&limit=200`,
  );
  const recorded = listed.items.find((run) => run.trace_sha256 !== "" && run.id !== again);
  if (!recorded) throw new Error("no other run of the network is recorded");
  await find.fill(`${url}/runs/${recorded.id}`);
  await page.locator(".choice .list").getByTitle(recorded.id).click();
  await page.locator(".compare-line").waitFor();
  expect(new URL(page.url()).searchParams.get("with")).toBe(recorded.id);
  expect(complaints).toEqual([]);
  await context.close();
});

it("the gravest mark of the time line is at its moment, keeps its colour, and is explained", async () => {
  const { violations } = await api.get<{
    violations: { number: number; first: number | null; at_fault: boolean | null }[];
  }>(`/runs/${made.run}/timeline`);
  const gravest = violations.find(({ at_fault, first }) => at_fault && first !== null);
  if (!gravest) throw new Error("no violation of the run is the fault of an ego");
  const { page, context, complaints } = await open(browser, `${url}/runs/${made.run}`);
  const mark = page
    .locator(".timeline button.verdict")
    .getByText(String(gravest.number), { exact: true });
  await mark.waitFor();
  const [box, track] = await Promise.all([
    mark.boundingBox(),
    page.locator(".timeline .track").boundingBox(),
  ]);
  if (!box || !track) throw new Error("the time line is not drawn");
  const title = (await mark.getAttribute("title")) ?? "";
  const end = Number(/of ([\d.]+) s/.exec(await page.locator(".controls").innerText())?.[1]);
  const time = Number(/at ([\d.]+) s:/.exec(title)?.[1]);
  expect(Math.abs(box.x + box.width / 2 - track.x - (time / end) * track.width)).toBeLessThan(1.5);
  const colours = () =>
    mark.evaluate((element) => {
      const { color, backgroundColor } = getComputedStyle(element);
      return [color, backgroundColor];
    });
  const [ink, ground] = await colours();
  await mark.hover();
  expect((await colours())[0]).toBe(ink);
  expect((await colours())[1]).not.toBe(ink);
  expect(ground).not.toBe(ink);
  await page.locator(".timeline .legend").getByText("violation, with its number").waitFor();
  expect(complaints).toEqual([]);
  await context.close();
});
