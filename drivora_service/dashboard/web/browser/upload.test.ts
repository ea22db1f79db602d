import { mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, expect, inject, it } from "vitest";
import { Api } from "./support/api";
import { findings } from "./support/axe";
import { startBrowser } from "./support/browser";
import { drawn, open } from "./support/page";
import { REPOSITORY } from "./support/service";

interface Network {
  readonly sha256: string;
  readonly lanes: number;
  readonly drivable_km: number;
}

const TOWN = join(REPOSITORY, "sumo_nets", "tee-town", "tee-town.net.xml");
const WAITING = { timeout: 30_000 };
const folder = mkdtempSync(join(tmpdir(), "drivora-upload-"));
const url = inject("url");
const api = new Api(url);
/** The service may have networks of an earlier time. */
const name = `old-town-${Date.now()}`;
let browser: Browser;

beforeAll(async () => {
  browser = await startBrowser();
});
afterAll(async () => {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
});

/** Writes the file of a network, which differs from others by a comment. */
function file(fileName: string, comment = ""): string {
  const path = join(folder, fileName);
  const text = readFileSync(TOWN, "utf8");
  writeFileSync(path, text.replace("</net>", `<!-- ${comment} --></net>`));
  return path;
}

/** Drops a file on the screen, as from a window of files. */
async function drop(page: Page, path: string, fileName: string): Promise<void> {
  const text = readFileSync(path, "utf8");
  const transfer = await page.evaluateHandle(
    ([content, called]) => {
      const made = new DataTransfer();
      made.items.add(new File([content ?? ""], called ?? ""));
      return made;
    },
    [text, fileName],
  );
  await page.dispatchEvent("main h1", "dragover", { dataTransfer: transfer });
  await page.locator(".drop-here").waitFor();
  await page.dispatchEvent("main h1", "drop", { dataTransfer: transfer });
  await expect.poll(() => page.locator(".drop-here").count(), WAITING).toBe(0);
}

it("a network is imported by keys alone, and its map is opened", async () => {
  const { page, context, complaints } = await open(browser, `${url}/networks`);
  await page.keyboard.press("i");
  const panel = page.getByRole("region", { name: "Import a network" });
  await panel.waitFor();
  expect(await page.evaluate("document.activeElement.type")).toBe("file");
  expect(await findings(page)).toEqual([]);

  await page.keyboard.press("Escape");
  await expect.poll(() => panel.count(), WAITING).toBe(0);
  expect(await page.evaluate("document.activeElement.textContent")).toBe("Import a network");

  await page.keyboard.press("Enter");
  await page.locator(".import input[type=file]").setInputFiles(file(`${name} (1).net.xml`));
  const named = panel.getByLabel("Name");
  expect(await named.inputValue()).toBe(`${name}-1`);
  expect(await panel.getByLabel("Format").inputValue()).toBe("sumo");
  await named.fill("../old town");
  await expect
    .poll(() => panel.getByRole("button", { name: "Import" }).isDisabled(), WAITING)
    .toBe(true);
  await panel.getByText("A name has 1 to 64 letters").waitFor();
  await named.fill(name);
  await named.press("Enter");
  const { drivable_km } = await api.get<Network>("/networks/tee-town");
  await panel.getByText(`Imported ${name}: ${drivable_km.toFixed(1)} km of lanes`).waitFor();
  expect(await findings(page)).toEqual([]);
  await page.locator("tbody tr", { hasText: name }).waitFor();

  await page.keyboard.press("Enter");
  await page.waitForURL(({ pathname }) => pathname === `/networks/${name}`);
  await drawn(page);
  const network = await api.get<Network>(`/networks/${name}`);
  expect(await page.locator("main .answer").innerText()).toContain(`${network.lanes} lanes`);
  await page.locator("main canvas").waitFor();
  expect(complaints).toEqual([]);
  await context.close();
});

it("a dropped file is told why it is refused, and replaces a network only on request", async () => {
  const { page, context, complaints } = await open(browser, `${url}/networks/${name}`);
  const before = await api.get<Network>(`/networks/${name}`);
  await page.keyboard.press("g");
  await page.keyboard.press("n");
  await page.getByRole("button", { name: "Import a network" }).waitFor();
  const panel = page.getByRole("region", { name: "Import a network" });
  const refused = panel.getByRole("alert");
  const go = panel.getByRole("button", { name: "Import", exact: true });
  const replace = panel.getByRole("button", { name: `Replace ${name}` });

  const broken = join(folder, "broken.xml");
  writeFileSync(broken, "<net><edge></net>");
  await drop(page, broken, "broken.xml");
  // Its ending tells no format.
  expect(await go.isDisabled()).toBe(true);
  await panel.getByLabel("Format").selectOption("sumo");
  await go.click();
  await refused.filter({ hasText: "not well-formed XML: mismatched tag" }).waitFor();
  expect(await replace.count()).toBe(0);

  await drop(page, file("again.net.xml", "again"), "again.net.xml");
  expect(await panel.getByLabel("Name").inputValue()).toBe("again");
  await panel.getByLabel("Name").fill("tee-town");
  await go.click();
  await refused.filter({ hasText: "comes with Drivora" }).waitFor();
  expect(await panel.getByRole("button", { name: /Replace/ }).count()).toBe(0);
  await panel.getByLabel("Name").fill(name);
  expect(await refused.count()).toBe(0);
  await go.click();
  await refused.filter({ hasText: "is already imported; replace it" }).waitFor();
  expect(await findings(page)).toEqual([]);
  await replace.click();
  await panel.getByText(`Imported ${name}`).waitFor();
  const after = await api.get<Network>(`/networks/${name}`);
  expect(after.sha256).not.toBe(before.sha256);
  // The map is that of the new file, though this page has shown the old one.
  const asked = page.waitForResponse((answer) => answer.url().endsWith(`/${name}/geometry`));
  await panel.getByRole("link", { name: `Look at ${name}` }).click();
  expect(((await (await asked).json()) as Network).sha256).toBe(after.sha256);

  const refusals = complaints.filter((said) => !/status of (409|422)/.test(said));
  expect(refusals).toEqual([]);
  await context.close();
});

it("an import that is cancelled leaves nothing, and progress is told", async () => {
  const { page, context } = await open(browser, `${url}/networks`);
  const large = join(folder, "large.net.xml");
  writeFileSync(large, `<net>${" ".repeat(30_000_000)}</net>`);
  const client = await context.newCDPSession(page);
  await client.send("Network.enable");
  await client.send("Network.emulateNetworkConditions", {
    offline: false,
    latency: 0,
    downloadThroughput: -1,
    uploadThroughput: 2_000_000,
  });
  await page.getByRole("button", { name: "Import a network" }).click();
  await page.locator(".import input[type=file]").setInputFiles(large);
  await page.getByRole("button", { name: "Import", exact: true }).click();
  const progress = page.getByRole("progressbar", { name: "Sent" });
  await expect
    .poll(async () => Number(await progress.getAttribute("value")), WAITING)
    .toBeGreaterThan(0);
  expect(await page.locator(".sent").innerText()).toContain(
    `of ${(statSync(large).size / 1e6).toFixed(1)} MB`,
  );
  // Another file does not take its place, and a key that closes the panel does nothing.
  await page.keyboard.press("Escape");
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.getByText("Cancelled; nothing was imported.").waitFor();
  await client.detach();
  // The service takes the next one at once.
  await expect
    .poll(async () => {
      const answer = await fetch(`${url}/api/v1/networks?name=${name}-2&format=sumo&replace=true`, {
        method: "POST",
        headers: { "content-type": "application/xml" },
        body: readFileSync(TOWN),
      });
      return answer.status;
    }, WAITING)
    .toBe(201);
  await context.close();
});
