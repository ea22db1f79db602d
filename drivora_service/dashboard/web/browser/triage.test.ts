import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, expect, inject, it } from "vitest";
import { Api } from "./support/api";
import { findings } from "./support/axe";
import { startBrowser } from "./support/browser";
import { drawn, open, shoot, THEMES } from "./support/page";

interface Group {
  readonly id: string;
  readonly label: string;
  readonly names: readonly string[];
  readonly status: string;
  readonly note: string;
  readonly assignee: string;
  readonly failures: number;
  readonly changed_by: string;
  readonly since_baseline: string | null;
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

/** Without a GPU the browser may take half a minute for the pictures of a list that was left. */
const PATIENT = { timeout: 60_000 };
const LIMIT_MS = 180_000;
const [mine, theirs] = made.paired;
/** Without a GPU the browser computes half a minute for a list of pictures: an empty one instead. */
const withoutPictures = (page: Page) =>
  page.route("**/picture?*", (route) =>
    route.fulfill({
      contentType: "image/svg+xml",
      body: '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 4 1"/>',
    }),
  );
const listed = async (query: string) =>
  (await api.get<{ items: Group[] }>(`/failures/groups?limit=500&${query}`)).items;
const asked = (id: string) => api.get<Group>(`/failures/groups/${id}`);
const groupOf = (page: Page) => new URL(page.url()).searchParams.get("group") ?? "";
const status = (page: Page) => page.locator(".statuses button[aria-pressed=true]").innerText();

it(
  "groups are gone through and decided about by the keyboard alone",
  async () => {
    const before = await listed(`batch=${mine}`);
    expect(before.length).toBeGreaterThan(3);
    const { page, context, complaints } = await open(browser, `${url}/failures?batch=${mine}`);
    await page.locator(".group-cards li").first().waitFor();
    expect(await page.locator(".group-cards li").count()).toBe(before.length);
    await page.keyboard.press("j");
    await page.keyboard.press("Enter");
    await page.locator(".statuses").waitFor();
    expect(groupOf(page)).toBe(before[0]?.id);
    for (const [place, { id, failures }] of before.slice(0, 3).entries()) {
      await expect
        .poll(() => page.locator(".head").innerText(), PATIENT)
        .toContain(`${place + 1} of`);
      await page.locator(".statuses").waitFor();
      expect(groupOf(page)).toBe(id);
      await page.keyboard.press(String(place + 2));
      const decided = ["known", "fixed", "will not fix"][place] ?? "";
      await expect.poll(() => status(page), PATIENT).toBe(decided);
      expect((await asked(id)).status).toBe(decided.replaceAll(" ", "_"));
      // Its failures follow one another by the keyboard, too.
      await page.keyboard.press("j");
      await page.locator("tbody tr").first().waitFor();
      expect(await page.locator("tbody tr").count()).toBeLessThanOrEqual(failures);
      await page.keyboard.press("n");
    }
    await page.goto(`${url}/failures?batch=${mine}&status=fixed`);
    await drawn(page);
    await expect.poll(() => page.locator(".group-cards li").count(), PATIENT).toBe(1);
    expect(complaints).toEqual([]);
    await context.close();
  },
  LIMIT_MS,
);

it(
  "a note, a label and who takes care are there for a colleague with the link",
  async () => {
    const [first] = await listed(`batch=${mine}&status=known`);
    const id = first?.id ?? "";
    const { page, context, complaints } = await open(browser, `${url}/failures?group=${id}`);
    await page.getByLabel("Your name").fill("Ada");
    await page.getByLabel("Label").fill("crosses too late");
    await page.getByLabel("Assignee").fill("Bo");
    await page.getByLabel("Note").fill("See the second picture.");
    await page.getByRole("button", { name: "Save" }).click();
    await expect.poll(() => page.locator("h1").innerText(), PATIENT).toBe("crosses too late");
    const now = await asked(id);
    expect([now.note, now.assignee, now.changed_by]).toEqual([
      "See the second picture.",
      "Bo",
      "Ada",
    ]);
    const colleague = await open(browser, page.url());
    await expect
      .poll(() => colleague.page.locator("h1").innerText(), PATIENT)
      .toBe("crosses too late");
    await colleague.page.locator(".history summary").click();
    await expect
      .poll(() => colleague.page.locator(".history li").first().innerText(), PATIENT)
      .toContain("Ada: noted: See the second picture.");
    // What the colleague decides is shown here, and what is being written stays; it is not saved
    // over what the writer has not seen.
    await page.getByLabel("Note").fill("See the third picture.");
    await api.post(`/failures/groups/${id}:decide`, { label: "crosses late", by: "Bo" });
    await expect.poll(() => page.locator("h1").innerText(), PATIENT).toBe("crosses late");
    await page.getByRole("button", { name: "Save" }).click();
    await page.getByRole("alert").filter({ hasText: "Bo changed the group meanwhile" }).waitFor();
    expect((await asked(id)).note).toBe("See the second picture.");
    await page.getByRole("button", { name: "Save" }).click();
    await expect.poll(async () => (await asked(id)).note, PATIENT).toBe("See the third picture.");
    for (const theme of THEMES) {
      await page.emulateMedia({ colorScheme: theme });
      await shoot(page, "failure-group", theme);
      expect(await findings(page)).toEqual([]);
    }
    // The browser tells of the refusal alone.
    expect(complaints.filter((said) => !said.includes("409 (Conflict)"))).toEqual([]);
    expect(complaints.length).toBe(1);
    expect(colleague.complaints).toEqual([]);
    await colleague.context.close();
    await context.close();
  },
  LIMIT_MS,
);

it(
  "groups are merged, and a part of them is split off again",
  async () => {
    const [one, other] = (await listed(`batch=${mine}`)).filter(({ label }) => !label).slice(-2);
    if (!one || !other) throw new Error("two groups are needed");
    const total = (await asked(one.id)).failures + (await asked(other.id)).failures;
    const { page, context, complaints } = await open(browser, `${url}/suites`);
    await withoutPictures(page);
    await page.goto(`${url}/failures?batch=${mine}`);
    await page.locator(".group-cards li").first().waitFor();
    const boxes = page.locator(".group-cards input[type=checkbox]");
    const count = await boxes.count();
    await boxes.nth(count - 2).check();
    await boxes.nth(count - 1).check();
    await page.getByRole("button", { name: "Merge 2 groups" }).click();
    await page.getByRole("button", { name: "Merge them" }).click();
    await expect.poll(() => boxes.count(), PATIENT).toBe(count - 1);
    const merged = await asked(one.id);
    expect(merged.failures).toBe(total);
    expect((await asked(other.id)).id).toBe(merged.id);

    await page.goto(`${url}/failures?group=${merged.id}`);
    await page.locator("tbody tr").first().waitFor();
    await page.locator("tbody tr input[type=checkbox]").first().check();
    await page.getByLabel("Label of the new group").fill("the first alone");
    await page.getByRole("button", { name: "Split off 1 failure" }).click();
    await expect.poll(() => page.locator("h1").innerText(), PATIENT).toBe("the first alone");
    expect((await asked(groupOf(page))).failures).toBe(1);
    expect((await asked(merged.id)).failures).toBe(total - 1);
    expect(complaints).toEqual([]);
    await context.close();
  },
  LIMIT_MS,
);

it(
  "the first sentence says what is new since a baseline, and leads to it",
  async () => {
    const shown = `batch=${mine}&oracle=collision&at_fault=false`;
    const { page, context, complaints } = await open(browser, `${url}/suites`);
    await withoutPictures(page);
    await page.goto(`${url}/failures?${shown}`);
    await page.getByRole("button", { name: "Baseline" }).click();
    await page.getByLabel("Name or id of a batch, a campaign or a study").fill(theirs);
    await page.keyboard.press("Enter");
    await page.locator(".answer", { hasText: "Since the baseline" }).waitFor();
    expect(new URL(page.url()).searchParams.get("baseline")).toBe(theirs);
    const all = await listed(`${shown}&baseline=${theirs}`);
    const of = (since: string) => all.filter(({ since_baseline }) => since_baseline === since);
    expect(await page.locator(".answer").innerText()).toContain(`${of("new").length} new`);
    expect(of("new").length).toBeGreaterThan(0);
    await page.locator(".answer a", { hasText: `${of("new").length} new` }).click();
    await expect
      .poll(() => page.locator(".group-cards li").count(), PATIENT)
      .toBe(of("new").length);
    // The sentence still counts all of them; those that are gone have a picture, too.
    await page.locator(".answer a", { hasText: `${of("gone").length} gone` }).click();
    await expect
      .poll(() => page.locator(".group-cards li").count(), PATIENT)
      .toBe(of("gone").length);
    expect(await page.locator(".group-cards").innerText()).toContain("none left");
    // Anew, without the pictures that were shown before: drawing them takes long without a GPU.
    await page.goto(`${url}/failures?${shown}&baseline=${theirs}&since_baseline=gone`);
    await page.locator(".answer", { hasText: "Since the baseline" }).waitFor();
    await page.waitForFunction("[...document.images].every((image) => image.complete)");
    for (const theme of THEMES) {
      await page.emulateMedia({ colorScheme: theme });
      await shoot(page, "failures-since-baseline", theme);
      expect(await findings(page)).toEqual([]);
    }
    expect(complaints).toEqual([]);
    await context.close();
  },
  LIMIT_MS,
);

it(
  "a failure that was minimised shows its smallest form beside it",
  async () => {
    const found = await api.get<{
      items: readonly { id: number; run_id: string; oracle: string; group_id: string }[];
    }>(`/failures?batch=${made.collisions}&at_fault=true&oracle=collision&limit=1`);
    const [failure] = found.items;
    if (!failure) throw new Error("no ego is at fault in the collisions");
    const { id } = await api.post<{ id: string }>(`/runs/${failure.run_id}:minimize`, {
      oracle: failure.oracle,
    });
    await api.until<{ state: string }>(`/minimizations/${id}`, ({ state }) => state === "finished");
    const address = `${url}/failures?group=${failure.group_id}&id=${failure.id}`;
    const { page, context, complaints } = await open(browser, address);
    const form = page.locator(".minimised");
    await form.waitFor();
    expect(await form.innerText()).toContain("1-minimal");
    await form.getByRole("link", { name: "Minimised" }).click();
    await page.waitForURL(({ pathname }) => pathname === `/minimizations/${id}`);
    expect(complaints).toEqual([]);
    await context.close();
  },
  LIMIT_MS,
);
