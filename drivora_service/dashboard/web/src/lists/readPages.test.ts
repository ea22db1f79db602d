import { expect, it } from "vitest";
import { readPages } from "./readPages";

const PAGES = [
  { items: [1, 2], next_page_token: "b" },
  { items: [3, 4], next_page_token: "c" },
  { items: [5], next_page_token: null },
];
const ask = async ({ page_token = "a" }: { readonly page_token?: string }) =>
  PAGES["abc".indexOf(page_token)] ?? { items: [] };

it("a list is read page by page, to its end or to as many rows as are wanted", async () => {
  expect(await readPages(ask)).toEqual({ rows: [1, 2, 3, 4, 5], more: false });
  expect(await readPages(ask, 3)).toEqual({ rows: [1, 2, 3, 4], more: true });
  expect(await readPages(ask, 5)).toEqual({ rows: [1, 2, 3, 4, 5], more: false });
});
