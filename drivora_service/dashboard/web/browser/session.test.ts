import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Browser } from "playwright-core";
import { afterAll, beforeAll, expect, it } from "vitest";
import { Api } from "./support/api";
import { startBrowser } from "./support/browser";
import { longScenarios, postBatch, shortScenarios } from "./support/data";
import { drawn, open } from "./support/page";
import { drivora, Service } from "./support/service";

const folder = mkdtempSync(join(tmpdir(), "drivora-session-"));
// As a service does that listens beyond loopback.
const service = new Service(folder, { settings: { DRIVORA_REQUIRE_TOKENS: "true" } });
let browser: Browser;
let address: string;
let reader: string;
let submitter: string;
let administrator: string;

async function token(name: string, scope: string): Promise<string> {
  const words = ["tokens", "create", name, "--scope", scope, "--data-dir", folder, "--json"];
  return (JSON.parse(await drivora(...words)) as { token: string }).token;
}

beforeAll(async () => {
  reader = await token("reader", "read");
  submitter = await token("submitter", "submit");
  administrator = await token("administrator", "admin");
  [browser] = await Promise.all([startBrowser(), service.start()]);
  address = `http://127.0.0.1:${new URL(service.url).port}`;
});
afterAll(async () => {
  await browser.close();
  await service.stop();
  rmSync(folder, { recursive: true, force: true });
});

it("a reader signs in with a token, sees the screen of the address, and signs out", async () => {
  const api = new Api(address, submitter);
  const batch = await postBatch(api, "behind tokens", shortScenarios(2));
  const { page, context } = await open(browser, `${address}/batches/${batch}`);
  await page.getByLabel("Token").fill("wrong");
  await page.getByRole("button", { name: "Sign in" }).click();
  await page.locator("[role=alert]").waitFor();
  await page.getByLabel("Token").fill(reader);
  await page.getByRole("button", { name: "Sign in" }).click();
  await expect.poll(() => page.locator("main h1").innerText()).toContain("behind tokens");
  await page.locator(".live[data-state=live]").waitFor();

  const cookies = await context.cookies();
  expect(cookies).toHaveLength(1);
  expect(cookies[0]).toMatchObject({ httpOnly: true, sameSite: "Strict" });
  const stored = await page.evaluate("JSON.stringify([{ ...localStorage }, document.cookie])");
  expect(stored).not.toContain(reader);

  await page.reload();
  await drawn(page);
  expect(await page.locator("main h1").innerText()).toContain("behind tokens");
  // A cookie that reads may not post.
  const refused = await page.evaluate(
    `fetch("/api/v1/batches/${batch}:cancel", { method: "POST" }).then(({ status }) => status)`,
  );
  expect(refused).toBe(403);

  await page.goto(`${address}/session`);
  await page.getByRole("button", { name: "Sign out" }).click();
  await page.getByLabel("Token").waitFor();
  expect(await page.evaluate("fetch('/api/v1/runs').then(({ status }) => status)")).toBe(401);
  await context.close();
});

it("only an administrator is offered to import a network, and others are told why not", async () => {
  for (const [secret, scope] of [
    [submitter, "submit"],
    [administrator, "admin"],
  ] as const) {
    const { page, context } = await open(browser, `${address}/networks`);
    await page.getByLabel("Token").fill(secret);
    await page.getByRole("button", { name: "Sign in" }).click();
    await page.getByRole("button", { name: "Import a network" }).click();
    const panel = page.getByRole("region", { name: "Import a network" });
    if (scope === "admin") await panel.getByText("Choose a file").waitFor();
    else await panel.getByText("you are signed in with the scope submit").waitFor();
    // The cookie of a page may do what its token may.
    const status = await page.evaluate(
      `fetch("/api/v1/networks?name=${scope}&format=sumo", {
        method: "POST", body: "<net/>", headers: { "content-type": "text/xml" }
      }).then(({ status }) => status)`,
    );
    expect(status).toBe(scope === "admin" ? 422 : 403);
    await context.close();
  }
});

it("only a token that may submit is offered to minimise a failing run", async () => {
  const api = new Api(address, submitter);
  const batch = await postBatch(api, "failing", shortScenarios(16));
  await api.until<{ done: boolean }>(`/batches/${batch}`, ({ done }) => done);
  const { items } = await api.get<{ items: { id: string }[] }>(
    `/runs?batch=${batch}&at_fault=true&limit=1`,
  );
  const offered: number[] = [];
  for (const token of [reader, submitter]) {
    const { page, context } = await open(browser, `${address}/runs/${items[0]?.id}`);
    await page.getByLabel("Token").fill(token);
    await page.getByRole("button", { name: "Sign in" }).click();
    await page.getByRole("button", { name: "Copy the id" }).waitFor();
    offered.push(await page.getByRole("button", { name: "Minimise" }).count());
    await context.close();
  }
  expect(offered).toEqual([0, 1]);
});

it("a run without a recording is run again by a token that may submit", async () => {
  const api = new Api(address, submitter);
  const batch = await postBatch(api, "given up", longScenarios(3));
  await api.post(`/batches/${batch}:cancel`);
  await api.until<{ done: boolean }>(`/batches/${batch}`, ({ done }) => done);
  const { items } = await api.get<{ items: { id: string }[] }>(
    `/runs?batch=${batch}&status=cancelled&limit=1`,
  );
  const offered: number[] = [];
  for (const token of [reader, submitter]) {
    const { page, context } = await open(browser, `${address}/runs/${items[0]?.id}`);
    await page.getByLabel("Token").fill(token);
    await page.getByRole("button", { name: "Sign in" }).click();
    await page.getByText("neither passes nor fails").waitFor();
    offered.push(await page.getByRole("button", { name: "Run it again here" }).count());
    const why = page.getByText("sign in with a token that may submit");
    expect(await why.count()).toBe(token === reader ? 1 : 0);
    await context.close();
  }
  expect(offered).toEqual([0, 1]);
});

it("an empty list leads to the form, which says what a token that may only read may not", async () => {
  const { page, context } = await open(browser, `${address}/campaigns`);
  await page.getByLabel("Token").fill(reader);
  await page.getByRole("button", { name: "Sign in" }).click();
  await page.getByRole("heading", { name: "No campaign yet" }).waitFor();
  expect(await page.getByRole("link", { name: "Compose one here" }).count()).toBe(0);
  await page.goto(`${address}/campaigns/new`);
  await page.getByText("Your token may read only.").waitFor();
  await page.getByLabel("Example scenario").selectOption("market street");
  await page.getByRole("button", { name: "Use it" }).click();
  // The document is there for a command, and nothing was refused.
  await page.getByText("town: tee-town").waitFor();
  const start = page.getByRole("button", { name: "Start the campaign" });
  expect(await start.isDisabled()).toBe(true);
  await context.close();

  const other = await open(browser, `${address}/campaigns`);
  await other.page.getByLabel("Token").fill(submitter);
  await other.page.getByRole("button", { name: "Sign in" }).click();
  await other.page.getByRole("link", { name: "Compose one here" }).click();
  await other.page.getByLabel("Example scenario").selectOption("market street");
  await other.page.getByRole("button", { name: "Use it" }).click();
  await other.page.getByText(/^Ready/).waitFor();
  // Another tab has signed in with a token that may only read.
  await other.page.evaluate(
    `fetch("/api/v1/session", { method: "POST", body: ${JSON.stringify(JSON.stringify({ token: reader }))},
      headers: { "content-type": "application/json" } }).then(({ status }) => status)`,
  );
  await other.page.getByRole("button", { name: "Start the campaign" }).click();
  const refusal = other.page.getByRole("alert");
  await refusal.waitFor();
  expect(await refusal.innerText()).toMatch(/403[\s\S]*submit/);
  expect((await new Api(address, reader).get<{ items: [] }>("/campaigns")).items).toEqual([]);
  await other.context.close();
});
