import { expect, it } from "vitest";
import { fileNameOf, readDocument } from "./files";

it("a file is read by its ending, and its errors name it", async () => {
  const read = { name: "left turn", document: { seed: 1 } };
  expect(await readDocument("left turn.json", '{"seed": 1}')).toEqual(read);
  expect(await readDocument("left turn.yml", "seed: 1")).toEqual(read);
  await expect(readDocument("a.json", "seed: 1")).rejects.toThrow(/^a\.json is not JSON: /);
  await expect(readDocument("a.yaml", "a: [1")).rejects.toThrow(/^a\.yaml is not YAML: .*line 1/);
  await expect(readDocument("a.json", "[]")).rejects.toThrow("a.json is not one object");
});

it("a name becomes that of a file", () => {
  expect(fileNameOf("Left turn, idm / random")).toBe("Left-turn-idm-random");
  expect(fileNameOf("../..")).toBe("document");
});
