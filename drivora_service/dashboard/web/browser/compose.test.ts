import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Browser, Locator, Page } from "playwright-core";
import { afterAll, beforeAll, expect, inject, it } from "vitest";
import { Api } from "./support/api";
import { findings } from "./support/axe";
import { startBrowser } from "./support/browser";
import { drawn, open, shoot, THEMES } from "./support/page";
import { drivora, REPOSITORY } from "./support/service";

const url = inject("url");
const made = inject("made");
const api = new Api(url);
const folder = mkdtempSync(join(tmpdir(), "drivora-compose-"));
const SMOKE = join(REPOSITORY, "openscenario_schemas", "suites", "smoke", "scenarios");
const EXAMPLES = join(REPOSITORY, "openscenario_schemas", "examples", "campaigns");
let browser: Browser;

beforeAll(async () => {
  browser = await startBrowser();
});
afterAll(async () => {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
});

interface Stored {
  readonly id: string;
  readonly name: string;
  readonly state: string;
  readonly document: Readonly<Record<string, unknown>>;
}

interface Judged {
  readonly ended_at: string | null;
  readonly failures: number | null;
}

const path = (page: Page) => new URL(page.url()).pathname;
const status = (page: Page) => page.getByRole("region", { name: "Start" }).getByRole("status");
const ready = (page: Page) =>
  status(page)
    .getByText(/^Ready/)
    .waitFor();
/** What the browser complains of, without the refusals of documents that have problems. */
const unexpected = (complaints: readonly string[]) =>
  complaints.filter((said) => !/422 .*:validate/.test(said));

const DROP_BROKEN_FILE = `
  const transfer = new DataTransfer();
  transfer.items.add(new File(['{"ego_vehicles": '], "broken.json"));
  const dropped = { dataTransfer: transfer, bubbles: true, cancelable: true };
  document.querySelector(".seeds").dispatchEvent(new DragEvent("drop", dropped));
`;

async function hasFocus(wanted: Locator): Promise<boolean> {
  return (await wanted.count()) > 0 && wanted.evaluate((one) => one === document.activeElement);
}

/** Presses `tab` until something has the focus: it has to be reached by keys alone. */
async function tabTo(page: Page, wanted: Locator): Promise<void> {
  for (let presses = 0; presses < 80; presses++) {
    if (await hasFocus(wanted)) return;
    await page.keyboard.press("Tab");
  }
  throw new Error(`${wanted} is not reached by the tabulator`);
}

/** Returns the document that the form shows, as JSON. */
async function shown(page: Page): Promise<Record<string, unknown>> {
  await page.getByRole("button", { name: "JSON", exact: true }).click();
  const text = await page.getByRole("region", { name: "Document" }).locator("pre").innerText();
  return JSON.parse(text) as Record<string, unknown>;
}

function scenario(name: string): Record<string, unknown> {
  return JSON.parse(readFileSync(join(EXAMPLES, name), "utf8")) as Record<string, unknown>;
}

it("a campaign is composed by keys alone, mended, started, and ends in sight", async () => {
  const { page, context, complaints } = await open(browser, `${url}/campaigns`);
  await page.locator(".live[data-state=live]").waitFor();
  await page.evaluate("window.sameDocument = true");
  await page.keyboard.press("n");
  await page.waitForURL("**/campaigns/new");
  await page.getByText("Choose a scenario to begin.").waitFor();
  const start = page.getByRole("button", { name: "Start the campaign" });
  expect(await start.isDisabled()).toBe(true);

  await tabTo(page, page.getByLabel("Example scenario"));
  await page.keyboard.type("market");
  await tabTo(page, page.getByRole("button", { name: "Use it" }));
  await page.keyboard.press("Enter");
  await ready(page);
  expect(await status(page).innerText()).toMatch(/\d+ genes/);

  await tabTo(page, page.getByRole("radio", { name: "Random" }));
  await page.keyboard.press("ArrowUp"); // LawBreaker
  await page.keyboard.press("ArrowDown");
  await tabTo(page, page.getByRole("spinbutton", { name: "Simulations" }));
  await page.keyboard.press("Control+a");
  await page.keyboard.type("0");
  await status(page).getByText("1 problem").waitFor();
  const message = "found 0; it should be greater than or equal to 1";
  const field = page.getByRole("spinbutton", { name: "Simulations" });
  expect(await field.getAttribute("aria-invalid")).toBe("true");
  await page.locator(".field", { has: field }).getByText(message).waitFor();
  expect(await start.isDisabled()).toBe(true);
  for (const theme of THEMES) {
    await page.emulateMedia({ colorScheme: theme });
    await shoot(page, "campaign-new-problem", theme);
    expect(await findings(page)).toEqual([]);
  }

  const jump = page.getByRole("button", { name: "/budget/simulations" });
  await tabTo(page, jump);
  await page.keyboard.press("Enter");
  expect(await hasFocus(field)).toBe(true);
  await page.keyboard.press("Control+a");
  await page.keyboard.type("11");
  await page.keyboard.press("ArrowUp");
  expect(await field.inputValue()).toBe("12");
  await ready(page);
  await page.keyboard.press("Control+Enter");
  await page.waitForURL(/\/campaigns\/[0-9a-f-]{8,}$/);

  const id = path(page).split("/").at(-1);
  await page.getByRole("heading", { name: "market street, random" }).waitFor();
  const state = () => page.locator("main .head .mark").innerText();
  expect(await state()).toMatch(/queued|running|finished/);
  await expect.poll(state, { timeout: 60_000 }).toBe("finished");
  await expect
    .poll(() => page.locator("main .answer").first().innerText(), { timeout: 10_000 })
    .toContain("12 simulations");
  expect(await page.evaluate("window.sameDocument")).toBe(true);
  const { document } = await api.get<Stored>(`/campaigns/${id}`);
  expect(document).toMatchObject({
    tester: { name: "random" },
    scenario: { map_region: { town: "tee-town" } },
    budget: { simulations: 12 },
  });
  expect(unexpected(complaints)).toEqual([]);
  await context.close();
}, 150_000);

it("a small study is composed from files, checked, started, and ends in sight", async () => {
  const { page, context, complaints } = await open(browser, `${url}/studies`);
  await page.locator(".live[data-state=live]").waitFor();
  await page.keyboard.press("n");
  await page.waitForURL("**/studies/new");
  const yaml = join(folder, "left turn.yaml");
  writeFileSync(
    yaml,
    "ego_vehicles:\n  - {id: ego_0, model: vehicle.lincoln.mkz_2017, initial_speed: 8,\n" +
      "     route: [{x: 15.5, y: 286.0}, {x: 97.6, y: 325.1}], agent: {name: idm}}\n" +
      "map_region: {town: tee-town}\n",
  );
  const files = [yaml, join(EXAMPLES, "orchard-lane.json")];
  await page.getByLabel("Choose a file").setInputFiles(files);
  await page.getByRole("button", { name: "Remove orchard-lane" }).waitFor();
  await page.getByLabel("Another method").selectOption({ label: "AVFuzzer" });
  await page.getByRole("button", { name: "Add the method" }).click();
  await page.getByLabel("Another ADS").selectOption("idm-mobil");
  await page.getByRole("button", { name: "Add the ADS" }).click();
  await page.getByRole("spinbutton", { name: "Repetitions" }).fill("1");
  await page.getByRole("spinbutton", { name: "Simulations" }).fill("5");
  await ready(page);
  expect(await status(page).innerText()).toContain("4 campaigns, 20 simulations");

  // Two scenarios of one name.
  await page.getByLabel("Name of the scenario").last().fill("left turn");
  await status(page).getByText("1 problem").waitFor();
  await page.getByRole("button", { name: "/scenarios/1/label" }).click();
  expect(await hasFocus(page.getByLabel("Name of the scenario").last())).toBe(true);
  await page.keyboard.press("Control+a");
  await page.keyboard.type("meeting");
  await ready(page);
  for (const theme of THEMES) {
    await page.emulateMedia({ colorScheme: theme });
    await shoot(page, "study-new-ready", theme);
    expect(await findings(page)).toEqual([]);
  }

  // A look at another screen does not lose it.
  await page.getByRole("link", { name: "Agents" }).click();
  await drawn(page);
  await page.goBack();
  await ready(page);
  const document = await shown(page);
  await page.getByRole("button", { name: "Start the study" }).click();
  await page.waitForURL(/\/studies\/[0-9a-f-]{8,}$/);
  const id = path(page).split("/").at(-1);
  await page.getByRole("heading", { name: "2 scenarios, random and avfuzzer" }).waitFor();
  const state = () => page.locator("main .head .mark").first().innerText();
  await expect.poll(state, { timeout: 100_000 }).toBe("finished");
  const stored = await api.get<Stored>(`/studies/${id}`);
  expect(stored.document).toMatchObject({ name: document.name, agents: document.agents });
  const { items } = await api.get<{ items: { cell: { scenario: string } }[] }>(
    `/campaigns?study=${id}`,
  );
  expect(new Set(items.map(({ cell }) => cell.scenario))).toEqual(
    new Set(["left turn", "meeting"]),
  );
  expect(unexpected(complaints)).toEqual([]);
  await context.close();
}, 180_000);

it("a search begins from a run, and the file of the form does the same by a command", async () => {
  const { page, context, complaints } = await open(browser, `${url}/runs/${made.run}`);
  await page.getByRole("link", { name: "Search from here" }).click();
  await page.waitForURL(`**/campaigns/new?run=${made.run}`);
  await page.getByRole("spinbutton", { name: "Simulations" }).fill("3");
  await page.getByRole("spinbutton", { name: "Seed" }).fill("7");
  await page.getByLabel("Name", { exact: true }).fill("by a command");
  await ready(page);
  const coming = page.waitForEvent("download");
  await page.getByRole("button", { name: "Download" }).click();
  const download = await coming;
  const file = join(folder, download.suggestedFilename());
  await download.saveAs(file);
  const document = await shown(page);
  expect(document.scenario).toEqual(await api.get(`/runs/${made.run}/scenario`));

  // The command of the form in YAML, which is what it shows first.
  await page.getByRole("button", { name: "YAML" }).click();
  const command = await page.getByRole("button", { name: /^drivora campaign run/ }).innerText();
  expect(command).toContain(download.suggestedFilename());
  await drivora(
    ...command
      .replace(/^drivora /, "")
      .replace(download.suggestedFilename(), file)
      .split(" "),
  );
  const { items } = await api.get<{ items: Stored[] }>("/campaigns?limit=10");
  const started = items.find(({ name }) => name === "by a command");
  const { document: stored } = await api.get<Stored>(`/campaigns/${started?.id}`);
  expect(stored).toMatchObject({ seed: 7, budget: { simulations: 3 } });
  expect(stored.scenario).toMatchObject({
    map_region: (document.scenario as Stored["document"]).map_region,
  });
  expect(unexpected(complaints)).toEqual([]);
  await context.close();
}, 120_000);

it("a campaign is started again with another budget, and all else is the same", async () => {
  const before = await api.get<Stored>(`/campaigns/${made.campaign}`);
  const { page, context } = await open(browser, `${url}/campaigns/${made.campaign}`);
  await page.getByRole("link", { name: "Again with other settings" }).click();
  await page.waitForURL(`**/campaigns/new?campaign=${made.campaign}`);
  await page.getByRole("spinbutton", { name: "Simulations" }).fill("2");
  await ready(page);
  // What is the default is not in the document of the form.
  expect(await shown(page)).not.toHaveProperty("lookahead");
  await page.getByRole("button", { name: "Start the campaign" }).click();
  await page.waitForURL(/\/campaigns\/[0-9a-f-]{8,}$/);
  const after = await api.get<Stored>(`/campaigns/${path(page).split("/").at(-1)}`);
  expect(after.document).toEqual({
    ...before.document,
    name: `${before.name}, again`,
    budget: { simulations: 2 },
  });
  await context.close();
});

it("a search begins from an evaluation, and from what the author screen leaves", async () => {
  const { page, context } = await open(
    browser,
    `${url}/campaigns/${made.campaign}?tab=ancestry&number=3`,
  );
  await page.getByRole("link", { name: "Search from here" }).click();
  await page.waitForURL(`**/campaigns/new?campaign=${made.campaign}&evaluation=3`);
  await ready(page);
  expect((await shown(page)).scenario).toEqual(
    await api.get(`/campaigns/${made.campaign}/evaluations/3/scenario`),
  );

  await page.goto(`${url}/campaigns/new?from=author`);
  await page.getByText("The author screen has left no scenario").waitFor();
  const authored = scenario("church-lane.json");
  await page.evaluate(
    `sessionStorage.setItem("drivora:scenario", ${JSON.stringify(JSON.stringify(authored))})`,
  );
  await page.reload();
  await ready(page);
  expect((await shown(page)).scenario).toEqual(authored);
  await context.close();
});

it("what was defined as a failure for a run counts in a search that begins from it", async () => {
  const file = "tee-town-failure-to-yield-road-station-1-4.json";
  const content: unknown = JSON.parse(readFileSync(join(SMOKE, file), "utf8"));
  const asked = "label=fails%20to%20yield&counts=any&count_oracle=failure_to_yield";
  const { id } = await api.post<{ id: string }>(`/jobs?${asked}`, content);
  const { failures } = await api.until<Judged>(`/runs/${id}`, ({ ended_at }) => ended_at !== null);
  expect(failures).toBe(1);

  const { page, context } = await open(browser, `${url}/campaigns/new?run=${id}`);
  await ready(page);
  expect(await shown(page)).toMatchObject({ counts: "any", oracles: ["failure_to_yield"] });
  const section = page.getByRole("region", { name: "What counts as a failure" });
  await section.getByText("Of failure to yield.").waitFor();
  const start = page.getByRole("region", { name: "Start" });
  await start.getByText("Counts: violations of any fault, of failure to yield").waitFor();

  // What is taken back does not count any more.
  await start.getByRole("button", { name: "Change" }).click();
  expect(await hasFocus(section)).toBe(true);
  await section.getByLabel("Violations").selectOption("preventable");
  await section.getByRole("button", { name: "Back to the default" }).click();
  const changed = await shown(page);
  expect(changed).not.toHaveProperty("oracles");
  expect(changed.counts).toBe("preventable");
  await section.getByText("Of all oracles but observations.").waitFor();
  await section.getByLabel("Violations").selectOption("accountable");
  expect(await shown(page)).not.toHaveProperty("counts");
  await context.close();
});

it("what cannot be read or run is told where it is", async () => {
  const { page, context } = await open(browser, `${url}/campaigns/new`);
  await page.evaluate(DROP_BROKEN_FILE);
  await page.getByText("broken.json is not JSON").waitFor();
  await page.getByLabel("Id of a run").fill("none");
  await page.keyboard.press("Enter");
  await page.getByText("unknown run 'none'").waitFor();
  await page.getByLabel("Id of a run").fill(made.run);
  await page.keyboard.press("Enter");
  await ready(page);
  await page.getByRole("button", { name: "Begin again" }).click();
  await page.getByText("Choose a scenario to begin.").waitFor();
  const elsewhere = join(folder, "elsewhere.json");
  writeFileSync(
    elsewhere,
    JSON.stringify({ ...scenario("market-street.json"), map_region: { town: "Nowhere" } }),
  );
  await page.getByLabel("Choose a file").setInputFiles(elsewhere);
  await status(page).getByText("1 problem").waitFor();
  await page.getByRole("button", { name: "/scenario/map_region/town" }).click();
  const row = page.getByRole("listitem").filter({ has: page.getByLabel("Name of the scenario") });
  expect(await hasFocus(row)).toBe(true);
  expect(await row.innerText()).toContain("Nowhere");

  // A method that needs another space than the default, which it offers.
  await page.getByRole("button", { name: "Remove elsewhere" }).click();
  await page.getByLabel("Example scenario").selectOption("market street");
  await page.getByRole("button", { name: "Use it" }).click();
  await page.getByRole("radio", { name: "DoppelTest" }).check();
  await status(page).getByText("1 problem").waitFor();
  await page.getByRole("button", { name: "Vary that" }).click();
  await ready(page);
  expect(await shown(page)).toMatchObject({ space: { preset: "doppeltest" } });

  // The parameter of a method, in a part that is folded.
  await page.getByRole("radio", { name: "BehAVExplor" }).check();
  await page.locator("summary", { hasText: "Parameters" }).click();
  await page.getByLabel("Failures", { exact: true }).selectOption("campaign");
  await page.getByRole("spinbutton", { name: "Novelty" }).fill("2");
  await status(page).getByText("1 problem").waitFor();
  // What was set for a method is there again after a look at another one.
  await page.getByRole("radio", { name: "Random" }).check();
  await ready(page);
  await page.getByRole("radio", { name: "BehAVExplor" }).check();
  await page.getByRole("button", { name: "/tester/parameters/novelty" }).click();
  expect(await hasFocus(page.getByRole("spinbutton", { name: "Novelty" }))).toBe(true);
  await page.getByRole("button", { name: "Novelty: back to 0.4" }).click();
  await ready(page);
  expect(await shown(page)).toMatchObject({
    tester: { name: "behavexplor", parameters: { failures: "campaign" } },
  });
  await context.close();
});
