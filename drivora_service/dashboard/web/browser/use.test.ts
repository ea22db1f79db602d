import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, expect, inject, it } from "vitest";
import { Api } from "./support/api";
import { startBrowser } from "./support/browser";
import { postBatch, shortScenarios } from "./support/data";
import { drawn, open } from "./support/page";

const url = inject("url");
const made = inject("made");
const api = new Api(url);
let browser: Browser;

beforeAll(async () => {
  browser = await startBrowser();
});
afterAll(() => browser.close());

/** Returns what the list of runs says that it has. */
async function told(page: Page): Promise<string> {
  return page.locator("main .answer").first().innerText();
}

/** Returns the path, with the query if wanted, that the browser shows. */
function place(page: Page): string {
  return new URL(page.url()).pathname;
}

it("keys lead from screen to screen, and are listed", async () => {
  const { page, context, complaints } = await open(browser, `${url}/runs`);
  await page.keyboard.press("g");
  await page.keyboard.press("c");
  await expect.poll(() => place(page)).toBe("/campaigns");
  await page.locator("tbody tr").first().waitFor();
  await page.keyboard.press("?");
  await page.locator("dialog[open]").waitFor();
  const listed = await page.locator("dialog[open]").innerText();
  for (const does of ["next row", "go to runs"]) expect(listed).toContain(does);
  await page.keyboard.press("Escape");
  await expect.poll(() => page.locator("dialog[open]").count()).toBe(0);
  await page.keyboard.press("g");
  await page.keyboard.press("r");
  await expect.poll(() => place(page)).toBe("/runs");
  await drawn(page);
  expect(complaints).toEqual([]);
  await context.close();
});

it("a run is opened from its row by keys alone", async () => {
  const { page, context, complaints } = await open(browser, `${url}/runs?batch=${made.collisions}`);
  const current = page.locator("tr[data-current=true]");
  await page.keyboard.press("j");
  await page.keyboard.press("j");
  await page.keyboard.press("k");
  const row = await current.getAttribute("data-id");
  expect(row).toBeTruthy();
  await page.keyboard.press("Enter");
  await expect.poll(() => place(page)).toBe(`/runs/${row}`);
  await drawn(page);
  await page.goBack();
  await expect.poll(() => place(page)).toBe("/runs");
  await drawn(page);
  expect(complaints).toEqual([]);
  await context.close();
});

it("a filter is in the address, and a reload shows the same", async () => {
  const { page, context } = await open(browser, `${url}/runs?batch=${made.collisions}`);
  const counts = await api.get<{ total: number; at_fault: number }>(
    `/runs:counts?batch=${made.collisions}`,
  );
  await expect.poll(() => told(page)).toContain(`${counts.total} runs`);
  await page.getByRole("link", { name: `${counts.at_fault} with an ego at fault` }).click();
  await expect.poll(() => new URL(page.url()).searchParams.get("at_fault")).toBe("true");
  await expect.poll(() => told(page)).toContain(`${counts.at_fault} runs`);
  const rows = page.locator("tbody tr");
  await expect.poll(() => rows.count()).toBe(counts.at_fault);
  const before = await rows.allInnerTexts();
  await page.reload();
  await drawn(page);
  await expect.poll(() => rows.allInnerTexts()).toEqual(before);
  await page.goBack();
  await expect.poll(() => told(page)).toContain(`${counts.total} runs`);
  await context.close();
});

it("the batches of campaigns are left out by their priority", async () => {
  const { page, context, complaints } = await open(browser, `${url}/batches`);
  const rows = page.locator("tbody tr");
  const { items } = await api.get<{ items: { id: string }[] }>("/batches?priority=interactive");
  await expect.poll(() => rows.count()).toBeGreaterThan(items.length);
  await page.keyboard.press("/");
  await page.getByRole("button", { name: "interactive" }).click();
  await expect.poll(() => new URL(page.url()).searchParams.get("priority")).toBe("interactive");
  await expect.poll(() => rows.count()).toBe(items.length);
  for (const { id } of items) await page.locator(`tr[data-id="${id}"]`).waitFor();
  await page.getByRole("button", { name: "Clear filters" }).click();
  await expect.poll(() => rows.count()).toBeGreaterThan(items.length);
  expect(complaints).toEqual([]);
  await context.close();
});

it("an address leads deep into the data, for a new reader too", async () => {
  const at = `${url}/campaigns/${made.campaign}?tab=settings`;
  const { page, context } = await open(browser, at);
  expect(await page.locator("main h1").innerText()).toBe("meeting at a stop, doppeltest 1");
  const tab = page.locator(
    "[role=tab][aria-selected=true], [aria-current=true], [aria-current=page]",
  );
  await expect.poll(() => tab.allInnerTexts()).toContain("Settings");
  expect(page.url()).toBe(at);
  await context.close();
});

it("the list of campaigns and the page of one tell the same first failure", async () => {
  const { page, context, complaints } = await open(browser, `${url}/campaigns`);
  const { name } = await api.get<{ name: string }>(`/campaigns/${made.campaign}`);
  const { first_failure } = await api.get<{ first_failure: number }>(
    `/campaigns/${made.campaign}/discoveries`,
  );
  // Other tests start the campaign again with other settings, under a name that begins alike.
  const link = page.getByRole("link", { name, exact: true });
  const row = page.getByRole("row").filter({ has: link });
  await row.getByText(String(first_failure), { exact: true }).waitFor();
  await link.click();
  const facts = page.locator(".head-facts");
  await facts.getByText(`in simulation ${first_failure}`, { exact: true }).waitFor();
  const labels = await facts.locator("dt").allInnerTexts();
  expect(labels.slice(0, 5)).toEqual(["Method", "ADS", "Scene", "Simulations", "First failure"]);
  const kinds = page.getByRole("table", { name: "Kinds of failures" });
  await kinds
    .getByRole("link", { name: String(first_failure), exact: true })
    .first()
    .waitFor();
  expect(complaints).toEqual([]);
  await context.close();
});

it("an address of what is not there says so", async () => {
  const { page, context } = await open(browser, `${url}/runs/none`);
  await page.locator("[role=alert]").waitFor();
  expect(await page.locator("[role=alert]").innerText()).toContain("404");
  await context.close();
});

it("the theme that a reader chooses stays", async () => {
  const { page, context } = await open(browser, `${url}/agents`);
  await page.getByRole("button", { name: "Dark" }).click();
  await page.reload();
  await drawn(page);
  expect(await page.locator("html").getAttribute("data-theme")).toBe("dark");
  await context.close();
});

it("runs that are queued while the page is open appear without a reload", async () => {
  const { page, context, complaints } = await open(browser, `${url}/runs`);
  await page.locator(".live[data-state=live]").waitFor();
  await page.evaluate("window.sameDocument = true");
  const before = await api.get<{ total: number }>("/runs:counts");
  await expect.poll(() => told(page)).toContain(`${before.total} runs`);
  const batch = await postBatch(api, "while it is open", shortScenarios(2));
  await expect.poll(() => told(page), { timeout: 20_000 }).toContain(`${before.total + 2} runs`);
  // New rows wait until the reader asks for them.
  await page.locator("button.news", { hasText: "2 new" }).click();
  const { items } = await api.get<{ items: { id: string }[] }>(`/runs?batch=${batch}`);
  expect(items).toHaveLength(2);
  for (const { id } of items) await page.locator(`tr[data-id="${id}"]`).waitFor();
  await api.until<{ done: boolean }>(`/batches/${batch}`, ({ done }) => done);
  for (const { id } of items)
    await expect
      .poll(() => page.locator(`tr[data-id="${id}"]`).innerText(), { timeout: 20_000 })
      .toMatch(/violated|passed/);
  expect(await page.evaluate("window.sameDocument")).toBe(true);
  expect(complaints).toEqual([]);
  await context.close();
});
