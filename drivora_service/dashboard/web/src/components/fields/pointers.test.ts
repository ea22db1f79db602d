import { expect, it } from "vitest";
import { ancestry, below, keysOf, problemsAt, valueAt, withValue } from "./pointers";

it("keys with the signs of pointers are escaped", () => {
  const pointer = below(below("", "a/b"), "c~d");
  expect(pointer).toBe("/a~1b/c~0d");
  expect(keysOf(pointer)).toEqual(["a/b", "c~d"]);
  expect(ancestry("/space/reach")).toEqual(["/space/reach", "/space", ""]);
});

it("a value is read and replaced at its place, and nothing else changes", () => {
  const document = { methods: [{ name: "random" }, { name: "avfuzzer" }], seed: 1 };
  expect(valueAt(document, "/methods/1/name")).toBe("avfuzzer");
  expect(valueAt(document, "/methods/1/name/x")).toBeUndefined();
  const changed = withValue(document, "/methods/1/parameters/population", 8);
  expect(changed).toEqual({
    methods: [{ name: "random" }, { name: "avfuzzer", parameters: { population: 8 } }],
    seed: 1,
  });
  expect(document.methods[1]).toEqual({ name: "avfuzzer" });
  expect(Object.keys(withValue({ a: 1, b: 2 }, "/a", 3))).toEqual(["a", "b"]);
});

it("what becomes empty is removed, and the items of lists move up", () => {
  const document = { space: { reach: 50 }, agents: [{ name: "idm" }, { name: "nmpc" }] };
  expect(withValue(document, "/space/reach", undefined)).toEqual({ agents: document.agents });
  expect(withValue(document, "/agents/0", undefined).agents).toEqual([{ name: "nmpc" }]);
});

it("problems are found at a place, and inside of it where that is wanted", () => {
  const problems = [
    { pointer: "/scenario", message: "whole" },
    { pointer: "/scenario/seed", message: "inside" },
    { pointer: "/scenarios/0", message: "another" },
  ];
  const messages = (inside: boolean) =>
    problemsAt(problems, "/scenario", { inside }).map(({ message }) => message);
  expect(messages(false)).toEqual(["whole"]);
  expect(messages(true)).toEqual(["whole", "inside"]);
});
