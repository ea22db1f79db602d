import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Browser } from "playwright-core";
import { afterAll, beforeAll, expect, it } from "vitest";
import { Api } from "./support/api";
import { startBrowser } from "./support/browser";
import { meetingCampaign, postBatch, shortScenarios } from "./support/data";
import { open } from "./support/page";
import { Service } from "./support/service";

const SIMULATIONS = 15;
const folder = mkdtempSync(join(tmpdir(), "drivora-recovery-"));
const service = new Service(folder);
let browser: Browser;

interface Campaign {
  readonly state: string;
  readonly simulations: number;
  readonly counts: { readonly violating: number };
}

beforeAll(async () => {
  [browser] = await Promise.all([startBrowser(), service.start()]);
});
afterAll(async () => {
  await browser.close();
  await service.stop();
  rmSync(folder, { recursive: true, force: true });
});

it("a page that is open while the service is killed shows the end of all work", async () => {
  const api = new Api(service.url);
  const { id } = await api.post<{ id: string }>(
    "/campaigns",
    meetingCampaign("killed on its way", SIMULATIONS),
  );
  const batch = await postBatch(api, "beside it", shortScenarios(3));
  const campaigns = await open(browser, `${service.url}/campaigns`);
  const runs = await open(browser, `${service.url}/runs?batch=${batch}`);
  for (const { page } of [campaigns, runs]) {
    await page.locator(".live[data-state=live]").waitFor();
    await page.evaluate("window.sameDocument = true");
  }
  await api.until<Campaign>(`/campaigns/${id}`, ({ simulations }) => simulations >= 3);
  await service.kill();
  await campaigns.page.locator(".live[data-state=waiting]").waitFor();
  await runs.page.locator(".live[data-state=waiting]").waitFor();
  await service.start();

  for (const { page } of [campaigns, runs])
    await page.locator(".live[data-state=live]").waitFor({ timeout: 30_000 });
  const ended = await api.until<Campaign>(`/campaigns/${id}`, ({ state }) => state === "finished");
  expect(ended.simulations).toBe(SIMULATIONS);
  const row = campaigns.page.locator(`tr[data-id="${id}"]`);
  await expect.poll(() => row.innerText(), { timeout: 30_000 }).toContain("finished");
  await expect.poll(() => row.innerText()).toContain(String(SIMULATIONS));

  const counts = await api.until<{ total: number; status: Readonly<Record<string, number>> }>(
    `/runs:counts?batch=${batch}`,
    ({ status }) => !status.queued && !status.running,
  );
  expect(counts.total).toBe(3);
  const { items } = await api.get<{ items: { id: string; violations: number | null }[] }>(
    `/runs?batch=${batch}`,
  );
  for (const run of items) {
    const shown = runs.page.locator(`tr[data-id="${run.id}"]`);
    await expect
      .poll(() => shown.innerText(), { timeout: 30_000 })
      .toMatch(run.violations ? /violated/ : /passed/);
  }
  for (const { page } of [campaigns, runs])
    expect(await page.evaluate("window.sameDocument")).toBe(true);
}, 600_000);

it("a screen that is opened for the first time while the service is away is shown later", async () => {
  const { page } = await open(browser, `${service.url}/session`);
  await page.locator(".live[data-state=live]").waitFor();
  // Code that the page has not loaded before it is opened is refused like that of a dead service.
  await page.route("**/assets/Agents-*.js", (route) => route.abort());
  await service.kill();
  await page.locator(".live[data-state=waiting]").waitFor();
  await page.getByRole("link", { name: "Agents" }).click();
  await expect.poll(() => new URL(page.url()).pathname).toBe("/agents");
  await page.waitForTimeout(1500);
  expect(page.url()).toBe(`${service.url}/agents`);
  expect(await page.locator(".live").count()).toBe(1);

  await page.unroute("**/assets/Agents-*.js");
  await service.start();
  await page.getByRole("heading", { name: "Agents", level: 1 }).waitFor({ timeout: 30_000 });
  expect(await page.locator("[role=alert]").count()).toBe(0);
}, 120_000);
