import { mkdtempSync, renameSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Browser } from "playwright-core";
import { afterAll, beforeAll, expect, it } from "vitest";
import { Api } from "./support/api";
import { startBrowser } from "./support/browser";
import { postBatch, shortScenarios } from "./support/data";
import { open } from "./support/page";
import { Service } from "./support/service";

const folder = mkdtempSync(join(tmpdir(), "drivora-damaged-"));
const service = new Service(folder);
let browser: Browser;

beforeAll(async () => {
  [browser] = await Promise.all([startBrowser(), service.start()]);
});
afterAll(async () => {
  await browser.close();
  await service.stop();
  rmSync(folder, { recursive: true, force: true });
});

it("a replay says what is wrong with its trace instead of showing another run's", async () => {
  const api = new Api(service.url);
  const batch = await postBatch(api, "two", shortScenarios(2));
  const { items } = await api.until<{ items: readonly { id: string; status: string }[] }>(
    `/runs?batch=${batch}`,
    (runs) => runs.items.every(({ status }) => status === "finished"),
  );
  const [one, other] = items.map(({ id }) => id) as [string, string];
  const file = (id: string) => join(folder, "traces", id.slice(-2), `${id}.parquet`);
  renameSync(file(other), file(one));

  const exchanged = await open(browser, `${service.url}/runs/${one}`);
  const alert = exchanged.page.locator("main [role=alert]").first();
  await expect.poll(() => alert.innerText()).toContain(`run ${one}: its trace file ${one}.parquet`);
  const said = await alert.innerText();
  expect(said).toContain("is damaged or of another run");
  expect(said).toContain(`drivora replay ${one}`);
  expect(await exchanged.page.locator("main canvas").count()).toBe(0);
  // The verdicts are stored elsewhere, and are shown.
  expect(await exchanged.page.locator("main h1").innerText()).not.toBe("");

  const missing = await open(browser, `${service.url}/runs/${other}`);
  const refused = missing.page.locator("main [role=alert]").first();
  await expect.poll(() => refused.innerText()).toContain(`${other}.parquet is missing`);
  await Promise.all([exchanged.context.close(), missing.context.close()]);
});
