import { describe, expect, it } from "vitest";
import { newRows, renewed, settled } from "./merge";

interface Row {
  readonly id: string;
  readonly state: string;
}
const idOf = (row: Row) => row.id;
const rows = (...ids: string[]): Row[] => ids.map((id) => ({ id, state: "queued" }));

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
    const shown = { rows: rows("c", "b", "a"), left: new Set<string>() };
    const fresh = [{ id: "c", state: "running" }];
    const next = renewed(shown, fresh, new Set(["c", "b"]), idOf);
    expect(next.rows.map((row) => row.state)).toEqual(["running", "queued", "queued"]);
    expect([...next.left]).toEqual(["b"]);
    expect(settled(next, idOf).rows.map(idOf)).toEqual(["c", "a"]);
  });
  it("takes back a row that has come again", () => {
    const shown = { rows: rows("b"), left: new Set(["b"]) };
    expect(renewed(shown, rows("b"), new Set(["b"]), idOf).left.size).toBe(0);
  });
});
