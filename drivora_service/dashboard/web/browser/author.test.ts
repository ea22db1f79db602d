import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, expect, inject, it } from "vitest";
import { Api } from "./support/api";
import { findings } from "./support/axe";
import { startBrowser } from "./support/browser";
import { drawn, open, shoot, THEMES } from "./support/page";

interface Lane {
  readonly id: string;
  readonly edge: string;
  readonly kind: string;
  readonly drivable: boolean;
  readonly shape: readonly (readonly [number, number])[];
}
interface Place {
  readonly x: number;
  readonly y: number;
}
interface Scenario {
  readonly ego_vehicles: readonly {
    readonly id: string;
    readonly route: readonly Place[];
    readonly start_time?: number;
  }[];
  readonly npc_walkers?: readonly { readonly route: readonly Place[] }[];
  readonly map_region: { readonly town: string };
  readonly seed?: number;
}

const url = inject("url");
const made = inject("made");
const api = new Api(url);
const LIMIT_MS = 120_000;
const PATIENT = { timeout: 20_000 };
const TOWN = "signal-grid";
let browser: Browser;

beforeAll(async () => {
  browser = await startBrowser();
});
afterAll(async () => {
  await browser.close();
});

const answer = (page: Page) => page.locator(".answer").innerText();
const draft = async (page: Page): Promise<Scenario> => {
  // The browser keeps the draft a moment after a change.
  await page.waitForTimeout(450);
  return JSON.parse(
    (await page.evaluate("localStorage.getItem('drivora:draft')")) as string,
  ) as Scenario;
};
const begin = async (page: Page, town = TOWN) => {
  await page.getByRole("button", { name: town, exact: true }).click();
  await page.locator(".map canvas").waitFor();
};
const middle = async (page: Page): Promise<[number, number]> => {
  const box = await page.locator(".map canvas").boundingBox();
  if (!box) throw new Error("the map is not there");
  return [box.x + box.width / 2, box.y + box.height / 2];
};
const search = async (page: Page, name: string) => {
  await page.getByLabel("Search the map").fill(name);
  await page.getByLabel("Search the map").press("Enter");
  await page.waitForTimeout(300);
};

/** Straight lanes, in whose middle the middle of their box is. */
async function straightLanes(): Promise<readonly Lane[]> {
  const { lanes } = await api.get<{ lanes: Lane[] }>(`/networks/${TOWN}/geometry`);
  return lanes.filter(({ shape, kind, drivable }) => {
    const [a, b] = shape;
    const length = a && b ? Math.hypot(b[0] - a[0], b[1] - a[1]) : 0;
    return kind === "road" && drivable && shape.length === 2 && length > 60;
  });
}

/** Metres between a place and the centre line of a straight lane. */
function beside({ x, y }: Place, { shape }: Lane): number {
  const [[ax, ay], [bx, by]] = shape as readonly [
    readonly [number, number],
    readonly [number, number],
  ];
  const length = Math.hypot(bx - ax, by - ay);
  return Math.abs((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / length;
}

it(
  "a left turn with a walker is made by its kind of place, and its run is seen on the map",
  async () => {
    const { page, context, complaints } = await open(browser, `${url}/author`);
    await begin(page);
    await expect.poll(() => answer(page), PATIENT).toContain("problem");
    await page.getByLabel("Kind of place").selectOption("left turn that gives way");
    await page.locator(".author-place button").first().click();
    await page.getByRole("button", { name: "Ego drives it" }).click();
    await expect.poll(() => answer(page), PATIENT).toBe("It can be run");
    await page.getByLabel("Kind of place").selectOption("crossing");
    await page.locator(".author-place button").first().click();
    await page.getByRole("button", { name: "Walker crosses" }).click();
    await expect.poll(() => answer(page), PATIENT).toBe("It can be run");
    const written = await draft(page);
    expect(written.npc_walkers).toHaveLength(1);
    await page.getByRole("button", { name: "Run", exact: true }).click();
    await page.locator(".author-try .verdict-line").waitFor({ timeout: 60_000 });
    const run = (await page.getByRole("link", { name: "The run with" }).getAttribute("href")) ?? "";
    const id = run.slice(run.lastIndexOf("/") + 1);
    expect((await api.get<{ status: string }>(`/runs/${id}`)).status).toBe("finished");
    const driven = await api.get<Scenario>(`/runs/${id}/scenario`);
    expect(driven.ego_vehicles[0]?.route).toMatchObject(written.ego_vehicles[0]?.route ?? []);
    // The replay has begun on the map.
    await expect
      .poll(() => page.locator(".author-try .time").innerText(), PATIENT)
      .toMatch(/^(?!0\.00)\d+\.\d\d s/);
    await page.keyboard.press("Escape");
    await expect.poll(() => answer(page), PATIENT).toBe("It can be run");
    expect(await draft(page)).toEqual(written);
    expect(complaints).toEqual([]);
    await context.close();
  },
  LIMIT_MS,
);

it(
  "places go to their lane, are dragged along it, and come back by a step back",
  async () => {
    const [first, second] = await straightLanes();
    if (!first || !second) throw new Error(`${TOWN} has straight lanes`);
    const { page, context, complaints } = await open(browser, `${url}/author`);
    await begin(page);
    await search(page, first.id);
    await page.keyboard.press("Escape");
    await page.locator("h1").click();
    await page.keyboard.press("e");
    await page.mouse.click(...(await middle(page)));
    await search(page, second.id);
    await page.mouse.click(...(await middle(page)));
    await page.getByRole("button", { name: "End the route" }).click();
    const placed = await draft(page);
    const [start, end] = placed.ego_vehicles[0]?.route ?? [];
    if (!start || !end) throw new Error("the ego has a start and an end");
    expect(beside(start, first)).toBeLessThan(0.02);
    expect(beside(end, second)).toBeLessThan(0.02);
    // What the map shows as its way is what the service plans.
    const told = await api.post<{ actors: { path: [number, number][]; path_length: number }[] }>(
      "/scenarios:inspect",
      placed,
    );
    await expect
      .poll(() => page.locator(".author-part").nth(1).innerText(), PATIENT)
      .toContain(`${Math.round(told.actors[0]?.path_length ?? 0)} m long`);
    const [x, y] = await middle(page);
    const [[ax, ay], [bx, by]] = second.shape as [[number, number], [number, number]];
    const length = Math.hypot(bx - ax, by - ay);
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let step = 1; step <= 5; step++)
      await page.mouse.move(
        x + (10 * step * (bx - ax)) / length,
        y - (10 * step * (by - ay)) / length,
      );
    await page.mouse.up();
    const dragged = (await draft(page)).ego_vehicles[0]?.route[1];
    if (!dragged) throw new Error("the place is still there");
    expect(beside(dragged, second)).toBeLessThan(0.02);
    expect(Math.hypot(dragged.x - end.x, dragged.y - end.y)).toBeGreaterThan(2);
    await page.keyboard.press("u");
    expect(await draft(page)).toEqual(placed);
    await page.keyboard.press("y");
    expect((await draft(page)).ego_vehicles[0]?.route[1]).toEqual(dragged);
    expect(complaints).toEqual([]);
    await context.close();
  },
  LIMIT_MS,
);

it(
  "the text and the map say the same, and a text that cannot be read is told",
  async () => {
    const { page, context, complaints } = await open(browser, `${url}/author?run=${made.run}`);
    await page.locator(".map canvas").waitFor();
    const { ego_vehicles, ...opened } = await draft(page);
    // Short enough for all of its text to be in sight.
    const egos = ego_vehicles.map((ego) => ({ ...ego, route: [ego.route[0], ego.route.at(-1)] }));
    const before = { map_region: opened.map_region, ego_vehicles: egos };
    await page.keyboard.press("t");
    const text = page.locator(".author-text .cm-content");
    await text.waitFor();
    const id = egos[0]?.id ?? "";
    await expect.poll(() => text.innerText(), PATIENT).toContain(`"id": "${id}"`);
    await text.click();
    await page.keyboard.press("Control+a");
    await page.keyboard.insertText(JSON.stringify({ ...before, seed: 4711 }));
    expect((await draft(page)).seed).toBe(4711);
    await page.keyboard.press("Control+a");
    await page.keyboard.insertText('{ "seed": 5, ');
    await expect.poll(() => answer(page), PATIENT).toBe("The text cannot be read");
    // The map and the draft stay as they were read last.
    expect((await draft(page)).seed).toBe(4711);
    await page.keyboard.press("Control+z");
    await expect.poll(() => answer(page), PATIENT).not.toBe("The text cannot be read");
    await page.getByRole("button", { name: "YAML" }).click();
    await expect.poll(() => text.innerText(), PATIENT).toContain("seed: 4711");
    await page.getByRole("button", { name: "Fields", exact: true }).click();
    await expect
      .poll(() => page.getByRole("spinbutton", { name: "Seed" }).inputValue())
      .toBe("4711");
    await page.getByRole("spinbutton", { name: "Seed" }).fill("12");
    await page.getByRole("button", { name: "Text", exact: true }).click();
    await expect.poll(() => text.innerText(), PATIENT).toContain("seed: 12");
    expect(complaints).toEqual([]);
    await context.close();
  },
  LIMIT_MS,
);

it(
  "a problem is listed while it is written, and leads to its field",
  async () => {
    const { page, context } = await open(browser, `${url}/author?run=${made.run}`);
    await page.locator(".map canvas").waitFor();
    await expect.poll(() => answer(page), PATIENT).toContain("It can be run");
    const { ego_vehicles } = await draft(page);
    await page.keyboard.press("t");
    const text = page.locator(".author-text .cm-content");
    await text.click();
    await page.keyboard.press("Control+a");
    const [ego, ...others] = ego_vehicles;
    const wrong = { ...(await draft(page)), ego_vehicles: [{ ...ego, start_time: -1 }, ...others] };
    await page.keyboard.insertText(JSON.stringify(wrong));
    await expect.poll(() => answer(page), PATIENT).toBe("1 problem: it cannot be run yet");
    expect(await page.getByRole("button", { name: "Run", exact: true }).isDisabled()).toBe(true);
    await page.getByRole("button", { name: "Fields", exact: true }).click();
    expect(await page.locator(".author-problems button").innerText()).toContain("start time:");
    await page.locator(".author-problems button").click();
    const field = page.getByRole("spinbutton", { name: "Start time" });
    await expect
      .poll(() => field.evaluate((node) => node === document.activeElement), PATIENT)
      .toBe(true);
    await field.fill("2");
    await expect.poll(() => answer(page), PATIENT).toContain("It can be run");
    expect((await draft(page)).ego_vehicles[0]?.start_time).toBe(2);
    await context.close();
  },
  LIMIT_MS,
);

it(
  "a fresh scenario tells that it has no ego, leads to placing one, and the map keeps its place",
  async () => {
    const { page, context, complaints } = await open(browser, `${url}/author`);
    await begin(page);
    const problem = page.locator(".author-problems button");
    await problem.waitFor();
    expect(await problem.innerText()).toContain(
      "ego vehicles: found no item; at least 1 is needed",
    );
    // Under the fields of the scenario, it would be told of another thing.
    expect(await page.locator(".author-side .problem").count()).toBe(0);
    expect(await page.getByRole("button", { name: "Undo" }).isDisabled()).toBe(true);
    const before = await page.locator(".map canvas").boundingBox();
    await problem.click();
    const tool = page.getByRole("button", { name: "+ ego" });
    expect(await tool.getAttribute("aria-pressed")).toBe("true");
    await page.keyboard.press("Escape");
    await page.getByLabel("Kind of place").selectOption("left turn that gives way");
    await page.locator(".author-place button").first().click();
    await page.getByRole("button", { name: "Ego drives it" }).click();
    await expect.poll(() => answer(page), PATIENT).toBe("It can be run");
    expect(await page.locator(".map canvas").boundingBox()).toEqual(before);
    expect(await page.getByRole("button", { name: "Undo" }).isEnabled()).toBe(true);
    expect(complaints).toEqual([]);
    await context.close();
  },
  LIMIT_MS,
);

it(
  "a scenario is written and run by the keyboard alone",
  async () => {
    const { page, context } = await open(browser, `${url}/author`);
    await page.getByRole("button", { name: TOWN, exact: true }).focus();
    await page.keyboard.press("Enter");
    await page.locator(".map canvas").waitFor();
    const lanes = await straightLanes();
    const at = async (lane: Lane | undefined) => {
      await page.keyboard.press("/");
      await page.keyboard.press("Control+a");
      await page.keyboard.type(lane?.id ?? "");
      await page.keyboard.press("Enter");
      await page.keyboard.press("Escape");
      await page.waitForTimeout(300);
    };
    await at(lanes[0]);
    await page.keyboard.press("e");
    await page.keyboard.press("Enter");
    // Its way goes on at the middle of the map, too.
    await at(lanes.find(({ edge }) => edge !== lanes[0]?.edge));
    await page.keyboard.press("Space");
    await page.keyboard.press("Enter");
    await expect.poll(() => answer(page), PATIENT).toContain("It can be run");
    expect((await draft(page)).ego_vehicles[0]?.route).toHaveLength(2);
    const [start] = (await draft(page)).ego_vehicles[0]?.route ?? [];
    await page.keyboard.press("Shift+ArrowUp");
    const [moved] = (await draft(page)).ego_vehicles[0]?.route ?? [];
    expect((moved?.y ?? 0) - (start?.y ?? 0)).toBeCloseTo(5);
    await page.keyboard.press("u");
    await expect.poll(() => answer(page), PATIENT).toContain("It can be run");
    await page.keyboard.press("x");
    await page.locator(".author-try .verdict-line").waitFor({ timeout: 60_000 });
    await context.close();
  },
  LIMIT_MS,
);

it(
  "a scenario is handed to a campaign, and is still there afterwards",
  async () => {
    const { page, context, complaints } = await open(browser, `${url}/author?run=${made.run}`);
    await page.locator(".author .map canvas").waitFor();
    await expect.poll(() => answer(page), PATIENT).toContain("It can be run");
    // Both sides of the desk have been looked at before: they share what they ask for.
    await page.mouse.click(...(await middle(page)));
    await page.getByRole("button", { name: "Vary" }).click();
    await page.getByRole("heading", { name: "New campaign" }).waitFor();
    await expect
      .poll(() => page.locator("main").innerText(), PATIENT)
      .toContain("of the author screen");
    await page.goBack();
    await page.locator(".author .map canvas").waitFor();
    await page.getByRole("button", { name: "New", exact: true }).click();
    await page.getByRole("button", { name: /actors?, 20/ }).click();
    await expect.poll(() => answer(page), PATIENT).toContain("It can be run");
    expect(complaints).toEqual([]);
    await context.close();
  },
  LIMIT_MS,
);

it(
  "a run that was edited keeps its name, and is compared with what was tried",
  async () => {
    const { label, town } = await api.get<{ label: string; town: string }>(`/runs/${made.run}`);
    const name = label || town;
    const { page, context } = await open(browser, `${url}/author?run=${made.run}`);
    await page.locator(".author .map canvas").waitFor();
    expect(await page.getByRole("button", { name: "Undo" }).isDisabled()).toBe(true);
    await page.getByRole("spinbutton", { name: "Seed" }).fill("4711");
    expect((await draft(page)).seed).toBe(4711);
    // The origin is kept with the draft.
    await page.reload();
    await page.locator(".author .map canvas").waitFor();
    await expect.poll(() => answer(page), PATIENT).toContain("It can be run");
    await page.getByRole("button", { name: "Run", exact: true }).click();
    await page.locator(".author-try .verdict-line").waitFor({ timeout: 60_000 });
    const run = (await page.getByRole("link", { name: "The run with" }).getAttribute("href")) ?? "";
    const id = run.slice(run.lastIndexOf("/") + 1);
    expect((await api.get<{ label: string }>(`/runs/${id}`)).label).toBe(`${name}, edited`);
    await page.getByRole("link", { name: "Compare with the run it was edited from" }).click();
    await page.waitForURL(`**/runs/${id}?with=${made.run}`);
    await page.locator(".map canvas").waitFor();
    await page.goto(`${url}/author`);
    await page.getByRole("button", { name: "New", exact: true }).click();
    await page
      .getByRole("button", { name: `${name}, edited, ` })
      .first()
      .waitFor();
    await context.close();
  },
  LIMIT_MS,
);

it(
  "a failure is edited from its run",
  async () => {
    const { page, context } = await open(browser, `${url}/runs/${made.run}`);
    await page.getByRole("link", { name: "Edit" }).click();
    await page.locator(".author .map canvas").waitFor();
    await drawn(page);
    const { ego_vehicles } = await api.get<Scenario>(`/runs/${made.run}/scenario`);
    expect((await draft(page)).ego_vehicles).toEqual(ego_vehicles);
    await context.close();
  },
  LIMIT_MS,
);

it.each(THEMES)(
  "the author screen has no serious finding in the %s theme",
  async (theme) => {
    const { page, context } = await open(browser, `${url}/author?run=${made.run}`, theme);
    await page.locator(".map canvas").waitFor();
    await expect.poll(() => answer(page), PATIENT).toContain("It can be run");
    expect(await findings(page)).toEqual([]);
    await page.mouse.click(...(await middle(page)));
    await page.keyboard.press("t");
    await page.locator(".author-text .cm-content").waitFor();
    expect(await findings(page)).toEqual([]);
    await shoot(page, "author-text", theme);
    await context.close();
  },
  LIMIT_MS,
);
