import { describe, expect, it } from "vitest";
import { askedBy, offered, withoutFilters, withToggled, wordsFor } from "./filterValues";

const status = { name: "status", title: "Status", values: ["queued", "timed_out"] };
const agent = { name: "agent", title: "ADS", single: true, counts: { idm: 2, dilu: 7 } };

describe("filters", () => {
  it("gather values, and replace where the API takes one only", () => {
    const one = withToggled({ town: "x" }, status, "queued");
    expect(withToggled(one, status, "timed_out").status).toEqual(["queued", "timed_out"]);
    expect(withToggled({ agent: "idm" }, agent, "dilu").agent).toEqual(["dilu"]);
  });
  it("are taken away by the same value, and all at once without the rest of the address", () => {
    expect(withToggled({ status: ["queued"] }, status, "queued").status).toEqual([]);
    expect(withoutFilters({ status: "queued", order: "created_at" }, [status])).toEqual({
      order: "created_at",
    });
  });
  it("ask for one value or for a list, as the API takes them", () => {
    const search = { status: "queued", agent: ["idm"], order: "created_at" };
    expect(askedBy(search, [status, agent])).toEqual({ status: ["queued"], agent: "idm" });
  });
  it("offer the most frequent first, and what is chosen though nothing has it", () => {
    expect(offered(agent, ["nmpc"])).toEqual(["dilu", "idm", "nmpc"]);
    expect(wordsFor(status, "timed_out")).toBe("timed out");
  });
});
