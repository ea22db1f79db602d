import { expect, it } from "vitest";
import { allows, type Session } from "./scope";

const session = (part: Partial<Session>) =>
  ({ tokens_needed: true, scope: null, name: null, ...part }) as Session;

it("a scope allows what is below it, and a service without tokens everything", () => {
  expect(allows(session({ scope: "read" }), "submit")).toBe(false);
  expect(allows(session({ scope: "submit" }), "submit")).toBe(true);
  expect(allows(session({ scope: "admin" }), "read")).toBe(true);
  expect(allows(session({ scope: null }), "read")).toBe(false);
  expect(allows(session({ tokens_needed: false }), "admin")).toBe(true);
  expect(allows(undefined, "read")).toBe(false);
});
