/** A tab of the browser, in which nothing may go wrong unseen. */

import { mkdirSync } from "node:fs";
import { join } from "node:path";
import type { Browser, BrowserContext, Page } from "playwright-core";
import { expect } from "vitest";
import { REPOSITORY } from "./service";

const PICTURES = join(REPOSITORY, "build", "screenshots");

export type Theme = "light" | "dark";
export const THEMES: readonly Theme[] = ["light", "dark"];

export interface Opened {
  readonly page: Page;
  readonly context: BrowserContext;
  /** What the browser complained of: errors and warnings of the console, and refused requests. */
  readonly complaints: string[];
}

/** Notes every empty state that is shown, for however short a time. */
const NOTE_EMPTY_STATES = `
  window.emptyStates = [];
  new MutationObserver(() => {
    for (const { textContent } of document.querySelectorAll("main .state h2"))
      if (!window.emptyStates.includes(textContent)) window.emptyStates.push(textContent);
  }).observe(document, { childList: true, subtree: true, characterData: true });
`;

/** Returns the titles of the empty states that the page has shown since it was loaded. */
export async function emptyStates(page: Page): Promise<readonly string[]> {
  return (await page.evaluate("window.emptyStates")) as string[];
}

/** Opens an address of the service in a new window without cookies, and waits until it is drawn. */
export async function open(browser: Browser, address: string, theme: Theme = "light") {
  const context = await browser.newContext({
    colorScheme: theme,
    viewport: { width: 1440, height: 900 },
    reducedMotion: "reduce",
  });
  await context.addInitScript(NOTE_EMPTY_STATES);
  const page = await context.newPage();
  const complaints: string[] = [];
  page.on("pageerror", (error) => complaints.push(`error: ${error.message}`));
  page.on("console", (message) => {
    const kind = message.type();
    if (kind === "error" || kind === "warning") {
      complaints.push(`${kind}: ${message.text()} (${message.location().url})`);
    }
  });
  page.on("requestfailed", (request) => {
    const why = request.failure()?.errorText ?? "";
    // A screen that is left ends its requests.
    if (!why.includes("ERR_ABORTED")) complaints.push(`${request.url()}: ${why}`);
  });
  await page.goto(address);
  await drawn(page);
  return { page, context, complaints } satisfies Opened;
}

/** Waits until the screen has its content: a title, and nothing that loads. */
export async function drawn(page: Page): Promise<void> {
  await page.locator("main h1, main h2").first().waitFor();
  await expect.poll(() => page.locator("main .loading").count(), { timeout: 30_000 }).toBe(0);
}

/** Keeps a picture of what the window shows, for those who judge how it looks. */
export async function shoot(page: Page, name: string, theme: Theme): Promise<void> {
  mkdirSync(PICTURES, { recursive: true });
  await page.screenshot({ path: join(PICTURES, `${name}-${theme}.png`) });
}
