/** Measures the list of runs in the browser: `node browser/measure.ts URL ROUNDS`, JSON on stdout. */

import type { Page } from "playwright-core";
import { startBrowser } from "./support/browser.ts";

const [url = "", rounds = "10"] = process.argv.slice(2);

/** Tells when rows were painted that differ from those before. */
const WATCH = `
  window.painted = { rows: "", at: 0 };
  const rowsNow = () =>
    [...document.querySelectorAll("main tbody tr")].map((row) => row.dataset.id).join(" ");
  new MutationObserver(() => {
    const rows = rowsNow();
    if (rows === "" || rows === window.painted.rows) return;
    // After the next frame is drawn.
    requestAnimationFrame(() => setTimeout(() => {
      if (rows !== window.painted.rows) window.painted = { rows, at: performance.now() };
    }));
  }).observe(document, { childList: true, subtree: true });
  document.addEventListener("click", () => { window.clicked = performance.now(); }, true);
`;

interface Painted {
  readonly rows: string;
  readonly at: number;
}

async function painted(page: Page, before: string): Promise<Painted> {
  const deadline = Date.now() + 60_000;
  while (Date.now() < deadline) {
    const found = (await page.evaluate("window.painted")) as Painted;
    if (found.rows !== before) return found;
    await new Promise((done) => setTimeout(done, 20));
  }
  throw new Error("no other rows were painted within a minute");
}

const browser = await startBrowser();
const first: number[] = [];
const filter: number[] = [];
for (let round = 0; round < Number(rounds); round++) {
  // A new reader, with nothing in the browser's cache.
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 } });
  await context.addInitScript(WATCH);
  const page = await context.newPage();
  await page.goto(`${url}/runs`);
  const shown = await painted(page, "");
  first.push(shown.at);
  const link = page.getByRole("link", { name: "with an ego at fault" });
  await link.waitFor();
  await page.waitForTimeout(1000); // The counts of the filters are there, too.
  const before = (await page.evaluate("window.painted.rows")) as string;
  await link.click();
  const filtered = await painted(page, before);
  filter.push(filtered.at - ((await page.evaluate("window.clicked")) as number));
  await context.close();
}
await browser.close();
process.stdout.write(`${JSON.stringify({ first, filter })}\n`);
