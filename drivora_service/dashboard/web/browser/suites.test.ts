import type { Browser } from "playwright-core";
import { afterAll, beforeAll, expect, inject, it } from "vitest";
import { Api } from "./support/api";
import { startBrowser } from "./support/browser";
import { drawn, open } from "./support/page";

interface Outcome {
  readonly state: string;
  readonly run_id: string;
}
interface History {
  readonly runs: readonly {
    readonly id: string;
    readonly agent: string;
    readonly sentence: string;
  }[];
  readonly scenarios: readonly {
    readonly scenario: string;
    readonly outcomes: readonly (Outcome | null)[];
  }[];
}

const url = inject("url");
const made = inject("made");
const api = new Api(url);
let browser: Browser;

beforeAll(async () => {
  browser = await startBrowser();
});
afterAll(async () => {
  await browser.close();
});

it("a suite that CI ran says why its gate failed, and what changed since", async () => {
  const history = await api.get<History>(`/suites:history?suite=${made.suite}`);
  const changed = history.scenarios.filter(
    ({ outcomes: [before, after] }) => before && after && before.state !== after.state,
  );
  expect(history.runs.length).toBe(2);
  expect(changed.length).toBeGreaterThan(0);
  const { page, context, complaints } = await open(browser, url);
  await page.keyboard.press("g");
  await page.keyboard.press("u");
  await page.getByRole("link", { name: made.suite }).click();
  await drawn(page);
  await page.getByRole("button", { name: "ADS", exact: true }).click();
  await page.locator(".menu-panel button.item").first().waitFor();
  await page.keyboard.press("Escape");
  const last = history.runs[1];
  await page.locator(".decision", { hasText: last?.sentence ?? "none" }).waitFor();
  expect(await page.locator("main .head").innerText()).toContain("gate failed");

  // A strip for each scenario that did not always pass, and one line for each that changed.
  const telling = history.scenarios.filter(({ outcomes }) =>
    outcomes.some((one) => one !== null && one.state !== "passes"),
  );
  expect(await page.locator(".squares tbody tr").count()).toBe(telling.length);
  await page.getByRole("button", { name: "others" }).click();
  expect(await page.locator(".squares tbody tr").count()).toBe(history.scenarios.length);
  const lines = page.locator('section[aria-label="Old against new"] tbody tr');
  expect(await lines.count()).toBe(changed.length);

  // Each run is named by its ADS and its time: over its column, where two are compared, in the
  // figures and in their numbers.
  const drivers = history.runs.map(({ agent }) => agent);
  expect(new Set(drivers).size).toBe(2);
  const heads = page.locator(".squares thead th .run-name");
  for (const [place, driver] of drivers.entries()) {
    expect(await heads.nth(place).innerText()).toMatch(
      new RegExp(`^${driver}\\s+(\\d\\d-\\d\\d )?\\d\\d:\\d\\d`),
    );
    const choice = page.getByLabel(place === 0 ? "Old run" : "New run");
    expect(await choice.locator("option:checked").innerText()).toContain(`${driver}, `);
  }
  const heading = page.locator('section[aria-label="Old against new"] h2');
  expect(await heading.innerText()).toMatch(
    new RegExp(`^Old: ${drivers[0]}, .+ New: ${drivers[1]}, `),
  );
  expect(await page.locator(".decision").innerText()).toContain(`since ${drivers[0]}, `);
  const chart = page.getByRole("img", { name: "Scenarios that pass" });
  for (const driver of drivers) await chart.getByText(driver, { exact: true }).waitFor();
  expect(
    await page
      .getByRole("table", { name: "Scenarios that pass", includeHidden: true })
      .locator("thead th")
      .allTextContents(),
  ).toContain("ADS");

  const first = history.scenarios.find(({ scenario }) => scenario === changed[0]?.scenario);
  const line = lines.filter({ hasText: first?.scenario ?? "none" });
  await line.getByRole("link", { name: "Both, in step" }).click();
  await page.waitForURL(({ pathname }) => pathname === `/runs/${first?.outcomes[1]?.run_id}`);
  expect(new URL(page.url()).searchParams.get("with")).toBe(first?.outcomes[0]?.run_id);
  expect(complaints).toEqual([]);
  await context.close();
});

it("a square leads to the run behind it", async () => {
  const { page, context, complaints } = await open(browser, `${url}/suites?suite=${made.suite}`);
  const square = page.locator(".squares tbody a.square").first();
  const target = new URL((await square.getAttribute("href")) ?? "", url).pathname;
  await square.click();
  await page.waitForURL(({ pathname }) => pathname === target);
  await page.locator("main h1, main h2").first().waitFor();
  expect(complaints).toEqual([]);
  await context.close();
});
