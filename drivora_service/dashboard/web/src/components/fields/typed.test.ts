import { expect, it } from "vitest";
import { isSame, jsonTyped, listTyped, numberTyped, stepped, textOf } from "./typed";

it("what is no number stays what was typed", () => {
  expect(numberTyped(" 2.50 ")).toBe(2.5);
  expect(numberTyped("1e")).toBe("1e");
  expect(numberTyped("Infinity")).toBe("Infinity");
  expect(numberTyped("  ")).toBeUndefined();
});

it("lists and JSON are read, and shown as they were typed", () => {
  expect(listTyped("a, b ,,c", false)).toEqual(["a", "b", "c"]);
  expect(listTyped("1, x", true)).toEqual([1, "x"]);
  expect(listTyped(" , ", false)).toBeUndefined();
  expect(textOf(["a", "b"])).toBe("a, b");
  expect(jsonTyped('[{"a": 1}]')).toEqual([{ a: 1 }]);
  expect(jsonTyped("[")).toBe("[");
  expect(textOf([{ a: 1 }])).toBe('[{"a":1}]');
});

it("steps follow the size of a number, and stay within the bounds", () => {
  const decimal = { isWhole: false };
  expect(stepped(0.4, 1, decimal)).toBe(0.5);
  expect(stepped(0.05, -1, decimal)).toBe(0.04);
  expect(stepped(0.3, -1, decimal)).toBe(0.2);
  expect(stepped(12, 1, decimal)).toBe(13);
  expect(stepped(3, -1, { isWhole: true })).toBe(2);
  expect(stepped(0, -1, { isWhole: true, least: 0 })).toBe(0);
  expect(stepped(64, 1, { isWhole: true, most: 64 })).toBe(64);
});

it("values are the same whatever the order of their keys", () => {
  expect(isSame({ a: 1, b: [2] }, { b: [2], a: 1 })).toBe(true);
  expect(isSame({ a: 1 }, { a: 1, b: null })).toBe(false);
  expect(isSame([1], { 0: 1 })).toBe(false);
});
