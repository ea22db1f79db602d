import { describe, expect, it } from "vitest";
import { type Found, isId, matching } from "./found";

const found = (kind: Found["kind"], id: string, name = id): Found => ({ kind, id, name, note: "" });

describe("the search field", () => {
  it("puts whole names before beginnings and parts", () => {
    const all = [found("agent", "sumo-idm"), found("agent", "idm-mobil"), found("agent", "idm")];
    expect(matching(all, " IDM ").map(({ id }) => id)).toEqual(["idm", "idm-mobil", "sumo-idm"]);
  });
  it("finds by id and by name, and nothing for no text", () => {
    const batch = found("batch", "01a2", "nightly");
    expect(matching([batch], "night")).toHaveLength(1);
    expect(matching([batch], "01a")).toHaveLength(1);
    expect(matching([batch], "  ")).toHaveLength(0);
  });
  it("shows few of a kind, so that others are seen", () => {
    const runs = Array.from({ length: 20 }, (_, number) => found("run", `town-${number}`));
    const all = [...runs, found("network", "old-town")];
    expect(matching(all, "town").filter(({ kind }) => kind === "run")).toHaveLength(6);
    expect(matching(all, "town").at(-1)?.kind).toBe("network");
  });
  it("tells ids from words", () => {
    expect(isId("01a20b61ff86a4ffe185de78-17-again")).toBe(true);
    expect(isId("01a215ff5460f2a66a7526da-81f16c3e97bd4fr")).toBe(true);
    expect(isId("nightly")).toBe(false);
  });
});
