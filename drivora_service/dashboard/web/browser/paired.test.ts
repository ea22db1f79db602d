import { readFileSync } from "node:fs";
import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, expect, inject, it } from "vitest";
import { Api } from "./support/api";
import { startBrowser } from "./support/browser";
import { drawn, open } from "./support/page";

const url = inject("url");
const { paired } = inject("made");
const api = new Api(url);
let browser: Browser;

beforeAll(async () => {
  browser = await startBrowser();
});
afterAll(() => browser.close());

interface Answer {
  readonly sentence: string;
  readonly failures: Readonly<Record<"a_only" | "b_only" | "both" | "neither", number>>;
  readonly by_oracle: readonly { readonly oracle: string; readonly a_only: number }[];
  readonly pairs: readonly {
    readonly fails: string;
    readonly a: { readonly run: string; readonly status: string };
    readonly b: { readonly run: string };
  }[];
  readonly left_out: readonly { readonly scenario: string }[];
}

const [a, b] = paired;
const asked = () => api.get<Answer>(`/batches:compare?a=${a}&b=${b}`);
const words = (page: Page) => new URL(page.url()).searchParams;
const rows = (page: Page) => page.getByRole("table", { name: "Pairs" }).locator("tbody tr");

it("two batches are chosen by keys, the older one is A, and how they stand is told first", async () => {
  const { page, context, complaints } = await open(browser, `${url}/batches?priority=interactive`);
  for (const id of [b, a]) await page.getByLabel(`Select ${id}`).check();
  await page.keyboard.press("c");
  await expect.poll(() => new URL(page.url()).pathname).toBe("/compare/batches");
  await drawn(page);
  expect([words(page).get("a"), words(page).get("b")]).toEqual([a, b]);
  const { sentence } = await asked();
  expect(await page.locator(".standing").innerText()).toBe(sentence);
  expect(complaints).toEqual([]);
  await context.close();
});

it("a batch leads to its comparison with another one", async () => {
  const { page, context } = await open(browser, `${url}/batches/${a}`);
  await page.getByRole("button", { name: "Compare with…" }).click();
  await page.getByRole("link", { name: /^candidate/ }).click();
  await expect.poll(() => words(page).get("b")).toBe(b);
  await drawn(page);
  expect(words(page).get("a")).toBe(a);
  await page.getByRole("link", { name: "Swap A and B" }).click();
  await expect.poll(() => words(page).get("a")).toBe(b);
  await context.close();
});

it("each number leads to its pairs, and a pair to both replays", async () => {
  const { failures, by_oracle, pairs, left_out } = await asked();
  expect(failures.a_only).toBeGreaterThan(0);
  const { page, context, complaints } = await open(browser, `${url}/compare/batches?a=${a}&b=${b}`);
  const table = page.getByRole("table", { name: "Scenarios by which of A and B fails" });
  for (const fails of ["a_only", "neither"] as const) {
    await table.locator(`td[data-fails=${fails}] a`).click();
    await expect.poll(() => words(page).get("show")).toBe(fails);
    const expected = pairs.filter((pair) => pair.fails === fails).length;
    await expect.poll(() => page.locator(".pairs h2").innerText()).toBe(`${expected} pairs`);
  }
  const [first] = by_oracle.filter(({ a_only }) => a_only > 0);
  if (!first) throw new Error("no oracle tells A from B");
  const name = new RegExp(first.oracle.replaceAll("_", " "));
  const line = page.getByRole("table", { name: "Failures by oracle" }).getByRole("row", { name });
  await line
    .getByRole("link", { name: String(first.a_only), exact: true })
    .first()
    .click();
  await expect.poll(() => rows(page).count()).toBe(first.a_only);
  await page.getByText(`${left_out.length} left out of the comparison`).click();
  await page.getByRole("cell", { name: "B has no run of this scenario" }).waitFor();
  await rows(page).first().getByTitle("Both replays side by side").click();
  await expect.poll(() => new URL(page.url()).pathname).toMatch(/^\/runs\//);
  await drawn(page);
  const run = new URL(page.url()).pathname.split("/").at(-1);
  const opened = pairs.find((pair) => pair.a.run === run);
  expect([words(page).get("with"), words(page).get("view")]).toEqual([opened?.b.run, "side"]);
  expect(complaints).toEqual([]);
  await context.close();
});

it("what counts as a failure is in the address, and a reload shows the same", async () => {
  const { page, context } = await open(browser, `${url}/compare/batches?a=${a}&b=${b}`);
  await page.getByLabel("Failures are violations").selectOption("any");
  await expect.poll(() => words(page).get("counts")).toBe("any");
  await drawn(page);
  const { sentence } = await api.get<Answer>(`/batches:compare?a=${a}&b=${b}&counts=any`);
  await expect.poll(() => page.locator(".standing").innerText()).toBe(sentence);
  await page.reload();
  await drawn(page);
  expect(await page.locator(".standing").innerText()).toBe(sentence);
  await context.close();
});

it("pairs are in the order of the difference of a metric, which the address keeps", async () => {
  const { page, context, complaints } = await open(
    browser,
    `${url}/compare/batches?a=${a}&b=${b}&show=all`,
  );
  const header = page.getByRole("button", { name: /^B − A/ });
  await header.click();
  await header.click();
  await expect.poll(() => words(page).get("sort")).toBe("-driving_score difference");
  const at = await page
    .getByRole("table", { name: "Pairs" })
    .getByRole("columnheader")
    .allInnerTexts();
  const place = at.findIndex((title) => title.startsWith("B − A"));
  const cells = await rows(page).evaluateAll(
    (found, index) => found.map((row) => row.querySelectorAll("td")[index]?.textContent ?? ""),
    place,
  );
  const numbers = cells.filter(Boolean).map((text) => Number(text.replace("−", "-")));
  expect(numbers.length).toBeGreaterThan(1);
  expect(numbers).toEqual(numbers.toSorted((one, other) => other - one));
  expect(cells.slice(numbers.length)).toEqual(cells.slice(numbers.length).map(() => ""));
  expect(complaints).toEqual([]);
  await context.close();
});

it("the verdicts of a batch are a file for a spreadsheet, named after it", async () => {
  const { page, context, complaints } = await open(browser, `${url}/batches/${a}`);
  const name = await page.locator("main h1").innerText();
  await page.getByRole("button", { name: "Tables" }).click();
  const coming = page.waitForEvent("download");
  await page.getByRole("link", { name: "verdicts.csv" }).click();
  const download = await coming;
  expect(download.suggestedFilename()).toBe(`${name.replaceAll(" ", "-")}-verdicts.csv`);
  const [header = "", ...lines] = readFileSync(await download.path(), "utf8").split("\n");
  expect(header.split(",")).toEqual(expect.arrayContaining(["run_id", "oracle", "outcome"]));
  const { pairs } = await asked();
  const judged = pairs.filter(({ a: { status } }) => status === "finished");
  expect(judged.length).toBeGreaterThan(1);
  const told = new Set(lines.map((line) => line.split(",")[0]));
  expect(judged.filter((pair) => !told.has(pair.a.run)).map((pair) => pair.a.run)).toEqual([]);
  expect(complaints).toEqual([]);
  await context.close();
});
