import { readFileSync } from "node:fs";
import { join } from "node:path";
import type { Browser } from "playwright-core";
import { afterAll, beforeAll, describe, expect, inject, it } from "vitest";
import { findings } from "./support/axe";
import { startBrowser } from "./support/browser";
import { emptyStates, open, shoot, THEMES } from "./support/page";
import { screens } from "./support/screens";

const ROUTER = readFileSync(join(import.meta.dirname, "../src/router.tsx"), "utf8");

const url = inject("url");
const all = screens(inject("made"));
let browser: Browser;

beforeAll(async () => {
  browser = await startBrowser();
});
afterAll(() => browser.close());

it("every screen of the router is among those that are tried", () => {
  const routes = [...ROUTER.matchAll(/path: "(\/[^"]*)"/g)].map(([, path]) => path);
  expect(routes.length).toBeGreaterThan(1);
  expect(new Set(all.map(({ route }) => route))).toEqual(
    new Set(routes.filter((route) => route !== "/")),
  );
});

describe.each(THEMES)("in the %s theme", (theme) => {
  it.each(all)("$name opens without a complaint", async ({ name, at }) => {
    const { page, context, complaints } = await open(browser, url + at, theme);
    expect(await page.locator("html").getAttribute("data-theme")).toBe(theme);
    expect(await page.title()).toMatch(/\S – Drivora$/);
    await page.waitForLoadState("load");
    expect(await page.locator("[role=alert]").allTextContents()).toEqual([]);
    expect(await emptyStates(page)).toEqual([]);
    await shoot(page, name, theme);
    expect(await findings(page)).toEqual([]);
    const outside = await page.evaluate(
      "performance.getEntriesByType('resource').map((one) => new URL(one.name).origin)",
    );
    expect(new Set(outside as string[])).toEqual(new Set([url]));
    expect(complaints).toEqual([]);
    await context.close();
  });
});
