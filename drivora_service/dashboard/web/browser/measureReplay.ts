/**
 * Measures replays in the browser: `node browser/measureReplay.ts URL CROWD USUAL SECONDS ROUNDS`,
 * JSON on stdout. The run CROWD is played for some seconds, the run USUAL is opened some times.
 * Frames and the script between them come from the browser's own trace.
 */

import type { Browser, CDPSession, Page } from "playwright-core";
import { startBrowser } from "./support/browser.ts";

const [url = "", crowd = "", usual = "", seconds = "12", rounds = "5"] = process.argv.slice(2);
const VIEWPORT = { width: 1440, height: 900 };

interface TraceEvent {
  readonly name: string;
  readonly ph: string;
  readonly pid: number;
  readonly tid: number;
  /** Microseconds. */
  readonly ts: number;
  readonly dur?: number;
  readonly tdur?: number;
  readonly args?: { readonly name?: string };
}

/** Events in which the page's own code runs; some are inside of others. */
const SCRIPT = new Set([
  "FireAnimationFrame",
  "FireIdleCallback",
  "TimerFire",
  "EventDispatch",
  "FunctionCall",
  "RunMicrotasks",
  "EvaluateScript",
  "v8.callFunction",
]);

async function trace(session: CDPSession, during: () => Promise<void>): Promise<TraceEvent[]> {
  const events: TraceEvent[] = [];
  session.on("Tracing.dataCollected", ({ value }) => {
    events.push(...(value as unknown as TraceEvent[]));
  });
  await session.send("Tracing.start", {
    transferMode: "ReportEvents",
    traceConfig: { includedCategories: ["devtools.timeline", "v8"] },
  });
  await during();
  const complete = new Promise<void>((done) =>
    session.once("Tracing.tracingComplete", () => done()),
  );
  await session.send("Tracing.end");
  await complete;
  return events;
}

/** Returns the script of each frame in milliseconds, by the clock and of processor time. */
function scriptOfFrames(events: readonly TraceEvent[]): readonly { wall: number; cpu: number }[] {
  const thread = new Map<string, TraceEvent[]>();
  for (const event of events) {
    if (event.ph !== "X" || !SCRIPT.has(event.name)) continue;
    const key = `${event.pid} ${event.tid}`;
    thread.set(key, [...(thread.get(key) ?? []), event]);
  }
  // The thread of the page is the one that draws the frames.
  const frames = (one: readonly TraceEvent[]) =>
    one.filter(({ name }) => name === "FireAnimationFrame").length;
  const page = [...thread.values()].sort((a, b) => frames(b) - frames(a))[0] ?? [];
  const sorted = page.toSorted((a, b) => a.ts - b.ts || (b.dur ?? 0) - (a.dur ?? 0));
  const found: { wall: number; cpu: number }[] = [];
  let end = 0;
  let lastFrame = -1;
  for (const { name, ts, dur = 0, tdur = 0 } of sorted) {
    if (ts < end) continue; // Inside of the event before.
    end = ts + dur;
    // Several callbacks of one frame follow each other at once.
    if (name === "FireAnimationFrame" && ts - lastFrame > 4000) found.push({ wall: 0, cpu: 0 });
    if (name === "FireAnimationFrame") lastFrame = end;
    const frame = found.at(-1);
    if (!frame) continue;
    frame.wall += dur / 1000;
    frame.cpu += tdur / 1000;
  }
  return found;
}

async function playing(browser: Browser, address: string) {
  const context = await browser.newContext({ viewport: VIEWPORT });
  const page = await context.newPage();
  await page.goto(url + address);
  await page.getByRole("button", { name: "Play", exact: true }).waitFor();
  await page.waitForTimeout(3000); // All parts of the recording are there.
  const session = await browser.newBrowserCDPSession();
  const began = Date.now();
  const events = await trace(session, async () => {
    await page.keyboard.press(" ");
    await page.waitForTimeout(Number(seconds) * 1000);
  });
  const passed = (Date.now() - began) / 1000;
  await session.detach();
  await context.close();
  const frames = scriptOfFrames(events);
  return { seconds: passed, wall: frames.map((f) => f.wall), cpu: frames.map((f) => f.cpu) };
}

/** Returns when the first frame with actors was drawn, in milliseconds of the page. */
async function firstDrawn(page: Page): Promise<number> {
  for (;;) {
    // By the page's policy no text may become a function in it, as `waitForFunction` does.
    const [mark] = (await page.evaluate(
      "performance.getEntriesByName('replay: first frame').map(({ startTime }) => startTime)",
    )) as number[];
    if (mark !== undefined) return mark;
    await page.waitForTimeout(50);
  }
}

/** Returns the milliseconds from a navigation to the first frame with actors. */
async function firstFrame(browser: Browser): Promise<number> {
  const context = await browser.newContext({ viewport: VIEWPORT });
  const page = await context.newPage();
  await page.goto(`${url}/runs/${usual}`);
  const at = await firstDrawn(page);
  await context.close();
  return at;
}

/** The same from a click in the list of runs, with the code of the page already there. */
async function firstFrameFromList(browser: Browser): Promise<number> {
  const context = await browser.newContext({ viewport: VIEWPORT });
  const page = await context.newPage();
  await page.goto(`${url}/runs`);
  const row = page.locator(`main tbody tr[data-id="${usual}"] a`).last();
  await row.waitFor();
  await page.waitForTimeout(1500);
  await page.evaluate(
    "document.addEventListener('click', () => { window.clicked = performance.now(); }, true)",
  );
  await row.click();
  const took = (await firstDrawn(page)) - ((await page.evaluate("window.clicked")) as number);
  await context.close();
  return took;
}

const browser = await startBrowser();
const first: number[] = [];
const fromList: number[] = [];
for (let round = 0; round < Number(rounds); round++) {
  first.push(await firstFrame(browser));
  fromList.push(await firstFrameFromList(browser));
}
const whole = await playing(browser, `/runs/${crowd}`);
const followed = await playing(browser, `/runs/${crowd}?follow=ego_0&trails=all`);
await browser.close();
process.stdout.write(`${JSON.stringify({ first, from_list: fromList, whole, followed })}\n`);
