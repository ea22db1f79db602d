import { mkdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, inject, it } from "vitest";
import { startBrowser } from "./support/browser";
import { emptyStates, open, THEMES } from "./support/page";
import { screens } from "./support/screens";
import { REPOSITORY } from "./support/service";

const PICTURES = join(REPOSITORY, "build", "screenshots");
const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const ROUTER = readFileSync(join(import.meta.dirname, "../src/router.tsx"), "utf8");

const url = inject("url");
const all = screens(inject("made"));
let browser: Browser;

beforeAll(async () => {
  mkdirSync(PICTURES, { recursive: true });
  browser = await startBrowser();
});
afterAll(() => browser.close());

interface Finding {
  readonly id: string;
  readonly impact: string;
  readonly help: string;
  readonly nodes: readonly { readonly html: string; readonly failureSummary: string }[];
}

/** Returns the serious findings of axe-core about the screen. */
async function findings(page: Page): Promise<readonly string[]> {
  // Evaluated as a program of the tests: the page's own policy allows no other script.
  await page.evaluate(AXE);
  const found = (await page.evaluate("axe.run(document, { resultTypes: ['violations'] })")) as {
    readonly violations: readonly Finding[];
  };
  return found.violations
    .filter(({ impact }) => impact === "serious" || impact === "critical")
    .map(({ id, help, nodes }) => `${id}: ${help}: ${nodes[0]?.html} ${nodes[0]?.failureSummary}`);
}

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
    await page.screenshot({ path: join(PICTURES, `${name}-${theme}.png`) });
    expect(await findings(page)).toEqual([]);
    const outside = await page.evaluate(
      "performance.getEntriesByType('resource').map((one) => new URL(one.name).origin)",
    );
    expect(new Set(outside as string[])).toEqual(new Set([url]));
    expect(complaints).toEqual([]);
    await context.close();
  });
});
