/**
 * Pictures of the page for the documentation: `node browser/pictures.ts URL RUN FOLDER`.
 *
 * URL: a service with campaigns, a study and runs. RUN: the run that is replayed.
 */

import { copyFileSync } from "node:fs";
import { join } from "node:path";
import type { Browser, Page } from "playwright-core";
import { startBrowser } from "./support/browser.ts";

const [url = "", run = "", folder = "."] = process.argv.slice(2);
const SETTLED_MS = 2500;
/** Of the animation, which a README has to show. */
const SMALL = { width: 1024, height: 720 };

interface Listed<Item> {
  readonly items: readonly Item[];
}

async function asked<Answer>(path: string): Promise<Answer> {
  return (await (await fetch(`${url}/api/v1${path}`)).json()) as Answer;
}

async function opened(browser: Browser, path: string, viewport = { width: 1280, height: 800 }) {
  const context = await browser.newContext({ viewport, colorScheme: "light" });
  const page = await context.newPage();
  await page.goto(url + path);
  await page.locator("main h1").first().waitFor();
  await page.waitForTimeout(SETTLED_MS); // Pictures and figures are there, too.
  return page;
}

async function shoot(page: Page, name: string): Promise<void> {
  await page.screenshot({ path: join(folder, `${name}.png`) });
  await page.context().close();
}

const browser = await startBrowser();
const campaigns =
  await asked<
    Listed<{ readonly id: string; readonly tester: string; readonly counts: { avoidable: number } }>
  >("/campaigns?limit=500");
const telling = campaigns.items
  .filter(({ tester }) => tester !== "random")
  .toSorted((a, b) => b.counts.avoidable - a.counts.avoidable)[0];
const study = (await asked<Listed<{ readonly id: string }>>("/studies")).items[0];
await shoot(await opened(browser, `/campaigns/${telling?.id}`), "page-campaign");
await shoot(await opened(browser, `/studies/${study?.id}`), "page-study");
await shoot(await opened(browser, "/failures?accountability=avoidable"), "page-failures");
await shoot(await opened(browser, "/runs?violated=true"), "page-runs");
await shoot(await opened(browser, `/runs/${run}?t=7.6&perceived=yes`), "page-run");

const page = await opened(browser, `/runs/${run}?follow=ego_0`, SMALL);
for (let turn = 0; turn < 2; turn++) await page.keyboard.press("+");
await page.waitForTimeout(500);
const coming = page.waitForEvent("download", { timeout: 120_000 });
await page.getByRole("button", { name: "GIF" }).click();
copyFileSync(await (await coming).path(), join(folder, "replay.gif"));
await browser.close();
