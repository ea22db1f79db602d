import { expect, it } from "vitest";
import { readYaml, writeYaml } from "./yaml";

it("is read as version 1.1, as the service reads it", () => {
  expect(readYaml("a: yes\nb: 1.5\nc: [x, 2]\nd: 2026-01-01\ny: 3\ne: n\n")).toEqual({
    a: true,
    b: 1.5,
    c: ["x", 2],
    d: "2026-01-01",
    y: 3,
    e: "n",
  });
});

it("what cannot be read says where", () => {
  expect(() => readYaml("a: [1\nb: 2")).toThrow(/line 2/);
  expect(() => readYaml("a: 1\na: 2")).toThrow(/unique/);
  expect(() => readYaml("a: &x [1]\nb: *x")).toThrow("alias");
});

it("what is written reads back to the same, and short parts are on one line", () => {
  const position = { x: 1e-7, y: -2.5e21 };
  const value = {
    name: "no",
    tester: { name: "random" },
    at: [position, position],
    code: "1e3",
    when: "2026-01-01",
    none: null,
    empty: {},
    long: Array.from({ length: 60 }, (_, place) => place),
  };
  const text = writeYaml(value);
  expect(readYaml(text)).toEqual(value);
  expect(text).toContain("tester: {name: random}");
  expect(text).toContain("{x: 1.0e-7, y: -2.5e+21}");
  expect(text).toContain('name: "no"');
  expect(text).not.toMatch(/[&*]/);
});
