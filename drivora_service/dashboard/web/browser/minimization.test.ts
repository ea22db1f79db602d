import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Browser, Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, expect, inject, it } from "vitest";
import { Api } from "./support/api";
import { findings } from "./support/axe";
import { startBrowser } from "./support/browser";
import { longScenarios, postBatch } from "./support/data";
import { drawn, open, shoot, THEMES } from "./support/page";
import { drivora } from "./support/service";

const url = inject("url");
const made = inject("made");
const api = new Api(url);
const folder = mkdtempSync(join(tmpdir(), "drivora-minimization-"));
let browser: Browser;

beforeAll(async () => {
  browser = await startBrowser();
});
afterAll(async () => {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
});

interface Size {
  readonly actors: number;
  readonly waypoints: number;
  readonly route_m: number;
}
interface Minimization {
  readonly id: string;
  readonly run_id: string;
  readonly state: string;
  readonly failure: { readonly oracle: string; readonly ego: string };
  readonly before: Size | null;
  readonly after: Size | null;
  readonly one_minimal: boolean | null;
  readonly removed: readonly string[];
  readonly document: unknown;
  readonly reproduction_run_id: string;
  readonly minimal_run_id: string;
}

const asked = (id: string) => api.get<Minimization>(`/minimizations/${id}`);
const path = (page: Page) => new URL(page.url()).pathname;
const arrival = (page: Page, at: string) => page.waitForURL(({ pathname }) => pathname === at);
const state = (page: Page) => page.locator("main .head .mark").innerText();

/** Runs the scenario of a failing run once more, and returns the run, which was never minimised. */
async function failingAgain(): Promise<string> {
  const scenario = await api.get<Record<string, unknown>>(`/runs/${made.run}/scenario`);
  const batch = await postBatch(api, "fails again", [scenario]);
  await api.until<{ done: boolean }>(`/batches/${batch}`, ({ done }) => done);
  const { items } = await api.get<{ items: { id: string }[] }>(`/runs?batch=${batch}`);
  return items[0]?.id ?? "";
}

let ahead = "";

/** Queues runs that go before those of any minimisation. */
async function keepWorkersBusy(): Promise<void> {
  ahead = await postBatch(api, "goes before", longScenarios(60));
}

/** Cancels the runs that go before. */
async function freeWorkers(): Promise<void> {
  if (ahead) await api.post(`/batches/${ahead}:cancel`);
  ahead = "";
}
afterEach(freeWorkers);

it("a failing run is minimised by keys alone, and its screen shows the end by itself", async () => {
  const run = await failingAgain();
  await keepWorkersBusy();
  const { page, context, complaints } = await open(browser, `${url}/runs/${run}`);
  await page.locator(".live[data-state=live]").waitFor();
  await page.evaluate("window.sameDocument = true");
  await page.getByRole("button", { name: "Minimise" }).focus();
  await page.keyboard.press("Enter");
  await page.getByText("Which violation must come again?").waitFor();
  await page.keyboard.press("Enter");
  await page.waitForURL(/\/minimizations\//);
  const id = path(page).split("/").at(-1) ?? "";
  expect(await asked(id)).toMatchObject({ run_id: run, failure: { oracle: "collision" } });
  await page.getByRole("heading", { name: "Minimisation: collision of ego" }).waitFor();
  expect(await state(page)).toMatch(/queued|running/);
  await page.getByRole("progressbar", { name: "Decided of the budget" }).waitFor();
  for (const theme of THEMES) {
    await page.emulateMedia({ colorScheme: theme });
    await shoot(page, "minimization-running", theme);
    expect(await findings(page)).toEqual([]);
  }

  await freeWorkers();
  await expect.poll(() => state(page), { timeout: 50_000 }).toBe("finished, 1-minimal");
  const { before, after, removed } = await asked(id);
  const row = (name: string) =>
    page.getByRole("row", { name: new RegExp(`^${name}`) }).locator("td.number");
  const sizes = (of: (size: Size) => string) => [before, after].map((size) => size && of(size));
  await expect
    .poll(() => row("actors").allInnerTexts(), { timeout: 10_000 })
    .toEqual(sizes(({ actors }) => String(actors)));
  expect(await row("waypoints").allInnerTexts()).toEqual(
    sizes(({ waypoints }) => String(waypoints)),
  );
  expect(await row("routes of egos").allInnerTexts()).toEqual(
    sizes(({ route_m }) => route_m.toFixed(1)),
  );
  expect(await page.getByLabel("What was removed").getByRole("listitem").allInnerTexts()).toEqual(
    removed,
  );
  expect(await page.getByRole("button", { name: "Cancel" }).count()).toBe(0);
  expect(await page.evaluate("window.sameDocument")).toBe(true);

  await page.getByRole("link", { name: run }).click();
  await page.getByRole("link", { name: "its minimisation", exact: true }).click();
  await arrival(page, `/minimizations/${id}`);
  expect(complaints).toEqual([]);
  await context.close();
}, 120_000);

it("both runs are drawn, replayed and compared, and lead back", async () => {
  const { reproduction_run_id: was, minimal_run_id: now } = await asked(made.minimization);
  const at = `/minimizations/${made.minimization}`;
  const { page, context, complaints } = await open(browser, url + at);
  const loaded = "[...document.images].filter((one) => one.naturalWidth > 0).map((one) => one.alt)";
  await expect
    .poll(() => page.evaluate(loaded), { timeout: 20_000 })
    .toEqual(
      expect.arrayContaining([expect.stringMatching("before"), expect.stringMatching("after")]),
    );
  for (const [side, run] of [
    ["Before", was],
    ["After", now],
  ] as const) {
    await page.getByRole("region", { name: side }).getByRole("link", { name: "Replay" }).click();
    await arrival(page, `/runs/${run}`);
    await page.getByRole("link", { name: "its minimisation", exact: true }).click();
    await arrival(page, at);
  }
  await page.getByRole("link", { name: "Compare both replays" }).click();
  await page.getByLabel("The second run on the map").waitFor();
  expect([path(page), new URL(page.url()).searchParams.get("with")]).toEqual([`/runs/${was}`, now]);
  expect(complaints).toEqual([]);
  await context.close();
});

it("the smallest scenario is downloaded, and the command on the screen finds the same", async () => {
  const { document, failure, run_id } = await asked(made.minimization);
  const { page, context } = await open(browser, `${url}/minimizations/${made.minimization}`);
  const coming = page.waitForEvent("download");
  await page.getByRole("button", { name: "Download" }).click();
  const file = await (await coming).path();
  expect(JSON.parse(readFileSync(file, "utf8"))).toEqual(document);

  const copies = page.getByRole("button", { name: "Copy the command" });
  const command = (await copies.getAttribute("title"))?.replace("Copy: drivora ", "") ?? "";
  expect(command).toContain(`minimize ${run_id} --oracle ${failure.oracle}`);
  await drivora(...command.replace(/smaller$/, join(folder, "smaller.json")).split(" "));
  expect(JSON.parse(readFileSync(join(folder, "smaller.json"), "utf8"))).toEqual(document);
  await context.close();
}, 180_000);

it("a minimisation is cancelled after a question, and says what is left of it", async () => {
  await keepWorkersBusy();
  const { id } = await api.post<Minimization>(`/runs/${made.otherRun}:minimize`);
  const { page, context, complaints } = await open(browser, `${url}/minimizations/${id}`);
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.getByRole("button", { name: "Keep" }).click();
  expect(await state(page)).toMatch(/queued|running/);
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.getByRole("button", { name: "Cancel the minimisation" }).click();
  await expect.poll(() => state(page), { timeout: 10_000 }).toBe("cancelled");
  expect((await asked(id)).state).toBe("cancelled");
  expect(await page.getByRole("button", { name: "Cancel" }).count()).toBe(0);
  await page.getByRole("heading", { name: "There is no smaller scenario" }).waitFor();
  for (const theme of THEMES) {
    await page.emulateMedia({ colorScheme: theme });
    await shoot(page, "minimization-cancelled", theme);
    expect(await findings(page)).toEqual([]);
  }
  expect(complaints).toEqual([]);
  await context.close();
});

it("a minimisation of an earlier day is found from the failures and by the search", async () => {
  const { run_id, failure } = await asked(made.minimization);
  const { page, context, complaints } = await open(browser, `${url}/failures`);
  await page.getByRole("link", { name: "Minimisations" }).click();
  await arrival(page, "/minimizations");
  await drawn(page);
  const row = page.locator(`tr[data-id="${made.minimization}"]`);
  await row.waitFor();
  expect(await row.innerText()).toContain("finished, 1-minimal");
  await page.goto(`${url}/minimizations?run=${run_id}`);
  await drawn(page);
  const ids = (await api.get<{ items: Minimization[] }>(`/minimizations?run=${run_id}`)).items;
  await expect.poll(() => page.locator("tbody tr").count(), { timeout: 10_000 }).toBe(ids.length);
  await row.click();
  await arrival(page, `/minimizations/${made.minimization}`);

  await page.keyboard.press("s");
  await page.keyboard.type(made.minimization);
  const found = page.getByRole("option", { name: `${failure.ego}, minimised` });
  await found.waitFor();
  expect(await found.innerText()).toContain(failure.oracle.replaceAll("_", " "));
  expect(complaints.filter((said) => !said.includes("404"))).toEqual([]);
  await context.close();
});

it("a list that is open counts a minimisation that begins meanwhile", async () => {
  await keepWorkersBusy();
  const { page, context, complaints } = await open(browser, `${url}/minimizations`);
  await page.locator(".live[data-state=live]").waitFor();
  const { id } = await api.post<Minimization>(`/runs/${made.otherRun}:minimize`);
  await page.locator("button.news", { hasText: "1 new" }).click();
  const row = page.locator(`tr[data-id="${id}"]`);
  await row.waitFor();
  await freeWorkers();
  await expect.poll(() => row.innerText(), { timeout: 50_000 }).toContain("finished");
  expect(complaints).toEqual([]);
  await context.close();
}, 120_000);
