import { expect, it } from "vitest";
import { csvLines } from "./csv";

it("cells are quoted where a spreadsheet would misread them", () => {
  const rows = [
    ["plain", 'says "no"', "a,b"],
    ["two\nlines", null, -1.5],
    ["=SUM(A1)", "-3", true],
  ];
  expect(csvLines(rows)).toBe(
    `plain,"says ""no""","a,b"\r\n"two\nlines",,-1.5\r\n'=SUM(A1),'-3,true\r\n`,
  );
});
