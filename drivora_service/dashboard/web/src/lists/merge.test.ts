import { describe, expect, it } from "vitest";
import {
  coverage,
  inserted,
  newRows,
  type Overlay,
  renewed,
  rowsOf,
  settled,
  UNCHANGED,
} from "./merge";

interface Row {
  readonly id: string;
  readonly state: string;
}
const idOf = (row: Row) => row.id;
const rows = (...ids: string[]): Row[] => ids.map((id) => ({ id, state: "queued" }));
const start: Overlay<Row> = UNCHANGED;

describe("a list that is shown", () => {
  it("finds what is new before the first row that it has", () => {
    expect(newRows(rows("c", "b", "a"), rows("e", "d", "c", "b"), idOf).map(idOf)).toEqual([
      "e",
      "d",
    ]);
  });
  it("takes a whole fresh page as new where no row of it is known", () => {
    expect(newRows(rows("a"), rows("z", "y"), idOf)).toHaveLength(2);
  });
  it("renews rows in place, and keeps the place of one that has left until it is settled", () => {
    const read = rows("c", "b", "a");
    const next = renewed(start, [{ id: "c", state: "running" }], new Set(["c", "b"]), idOf);
    expect(rowsOf(read, next, idOf).map((row) => row.state)).toEqual([
      "running",
      "queued",
      "queued",
    ]);
    expect([...next.left]).toEqual(["b"]);
    expect(rowsOf(read, settled(next), idOf).map(idOf)).toEqual(["c", "a"]);
  });
  it("takes back a row that has come again", () => {
    const gone = settled(renewed(start, [], new Set(["b"]), idOf));
    expect(rowsOf(rows("b"), gone, idOf)).toHaveLength(0);
    expect(rowsOf(rows("b"), renewed(gone, rows("b"), new Set(), idOf), idOf)).toHaveLength(1);
  });
  it("inserts new rows before those that were inserted earlier", () => {
    const once = inserted({ ...start, news: rows("b") });
    const twice = inserted({ ...once, news: rows("c") });
    expect(rowsOf(rows("a"), twice, idOf).map(idOf)).toEqual(["c", "b", "a"]);
    expect(twice.news).toHaveLength(0);
  });
  it("knows which rows of a page an answer covers", () => {
    const page = rows("d", "c", "b", "a");
    // Two new rows push two others out.
    expect(coverage(page, rows("f", "e", "d", "c"), true, idOf)).toBe(2);
    // A row has left: the answer goes on behind the page.
    expect(coverage(page, rows("d", "c", "b", "0"), true, idOf)).toBe(4);
    // The whole list.
    expect(coverage(page, rows("f", "e"), false, idOf)).toBe(4);
    // Only new rows: what was pushed out is not known.
    expect(coverage(page, rows("z", "y", "x", "w"), true, idOf)).toBe(0);
  });
});
