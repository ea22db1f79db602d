import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { Api } from "./support/api";
import { startBrowser } from "./support/browser";
import { postBatch, shortScenarios } from "./support/data";
import { drawn, open } from "./support/page";
import { ReverseProxy } from "./support/reverseProxy";
import { drivora, REPOSITORY, Service } from "./support/service";

/** One passes the whole path on, the other takes the prefix off. */
const KINDS = ["caddy", "nginx-strips"] as const;
const TOWN = join(REPOSITORY, "sumo_nets", "tee-town", "tee-town.net.xml");
const WAITING = { timeout: 60_000 };
const SLOW = { timeout: 180_000 };
const folder = mkdtempSync(join(tmpdir(), "drivora-path-"));
const service = new Service(folder, {
  settings: { DRIVORA_REQUIRE_TOKENS: "true", DRIVORA_ROOT_PATH: "/drivora" },
});
let browser: Browser;
let token: string;

beforeAll(async () => {
  const words = ["tokens", "create", "all", "--scope", "admin", "--data-dir", folder, "--json"];
  token = (JSON.parse(await drivora(...words)) as { token: string }).token;
  [browser] = await Promise.all([startBrowser(), service.start()]);
});
afterAll(async () => {
  await browser.close();
  await service.stop();
  rmSync(folder, { recursive: true, force: true });
});

async function signIn(page: Page): Promise<void> {
  await page.getByLabel("Token").fill(token);
  await page.getByRole("button", { name: "Sign in" }).click();
}

/** Notes the addresses that a page and its workers ask for. */
function asked(page: Page): string[] {
  const found: string[] = [];
  page.context().on("request", (request) => found.push(request.url()));
  return found;
}

describe.each(KINDS)("behind %s", (kind) => {
  let proxy: ReverseProxy | undefined;
  let url = "";

  beforeAll(async () => {
    proxy = await ReverseProxy.start(kind, service.url, folder);
    url = proxy?.url ?? "";
  });
  afterAll(() => proxy?.stop());

  it("a deep link asks for a token, shows its screen, and goes on live", SLOW, async ({ skip }) => {
    if (!proxy) skip();
    const api = new Api(url, token);
    const batch = await postBatch(api, `behind ${kind}`, shortScenarios(2));
    await api.until<{ done: boolean }>(`/batches/${batch}`, ({ done }) => done);
    const { page, context, complaints } = await open(browser, `${url}/batches/${batch}`);
    const addresses = asked(page);
    await signIn(page);
    await expect.poll(() => page.locator("main h1").innerText()).toContain(`behind ${kind}`);
    await page.locator(".live[data-state=live]").waitFor();
    expect(await context.cookies()).toMatchObject([{ path: "/drivora", httpOnly: true }]);
    const refused = complaints.splice(0).filter((one) => !one.includes("401"));
    expect(refused).toEqual([]);

    // What others begin comes by the stream of events.
    await page.getByRole("link", { name: "Batches" }).click();
    await expect.poll(() => page.url()).toBe(`${url}/batches`);
    await page.getByRole("link", { name: `behind ${kind}` }).waitFor(WAITING);
    const later = await postBatch(api, `later behind ${kind}`, shortScenarios(1));
    await page.getByRole("button", { name: /1 new/ }).click(WAITING);
    await page.getByText(`later behind ${kind}`).waitFor(WAITING);
    await api.until<{ done: boolean }>(`/batches/${later}`, ({ done }) => done);

    // A screen with a recording, read in parts, and its files: code, workers, the map.
    const { items } = await api.get<{ items: { id: string }[] }>(`/runs?batch=${batch}&limit=1`);
    await page.goto(`${url}/runs/${items[0]?.id}`);
    await drawn(page);
    await page.locator(".controls .time").waitFor(WAITING);
    await page.reload();
    await page.locator(".controls .time").waitFor(WAITING);
    expect(await page.getByRole("link", { name: "Drivora" }).getAttribute("href")).toBe(
      "/drivora/",
    );
    const shown = await page.locator("main").innerHTML();
    expect(shown).not.toMatch(/(?:src|href)="\/(?!drivora)/);

    expect(complaints).toEqual([]);
    const outside = addresses.filter((one) => /^http/.test(one) && !one.startsWith(`${url}/`));
    expect(outside).toEqual([]);
    expect(addresses.length).toBeGreaterThan(20);
    await context.close();
  });

  it("files are sent and saved, and commands have the whole address", async ({ skip }) => {
    if (!proxy) skip();
    const { page, context, complaints } = await open(browser, `${url}/networks`);
    await signIn(page);
    await page.getByRole("button", { name: "Import a network" }).click();
    const panel = page.getByRole("region", { name: "Import a network" });
    await page.locator(".import input[type=file]").setInputFiles(TOWN);
    await panel.getByLabel("Name").fill(`town-${kind}`);
    await panel.getByRole("button", { name: "Import" }).click();
    await page.getByText(`town-${kind}`).first().waitFor(WAITING);

    await page.goto(`${url}/campaigns`);
    await page.getByText(`--server ${url}`).first().waitFor(WAITING);
    await page.goto(`${url}/runs`);
    await drawn(page);
    const coming = page.waitForEvent("download");
    await page.evaluate(
      `Object.assign(document.createElement("a"), { href: "${url}/api/v1/tables/runs", download: "runs.csv" }).click()`,
    );
    expect(readFileSync(await (await coming).path(), "utf8")).toMatch(/^[a-z_]+,/);

    await page.goto(`${url}/session`);
    await page.getByRole("button", { name: "Sign out" }).click();
    await page.getByLabel("Token").waitFor();
    expect(complaints.filter((one) => !one.includes("401"))).toEqual([]);
    await context.close();
  });
});

it("the service itself, asked without the path, leads to it", async () => {
  const { origin } = new URL(service.url);
  const { page, context } = await open(browser, `${origin}/batches?status=done`);
  expect(page.url()).toBe(`${origin}/drivora/batches?status=done`);
  await signIn(page);
  await page.getByRole("heading", { level: 1 }).waitFor();
  await context.close();
});
