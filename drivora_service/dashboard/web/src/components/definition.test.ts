import { expect, it } from "vitest";
import { COUNTED_CHOICES, countedOf, definitionSentence } from "./definition";

it("a number says what it counts, and who defined that", () => {
  const definition = {
    words: "violations of any fault (any), of all oracles but observations",
    counts: "any",
    oracles: null,
    definitions: 1,
  } as const;
  expect(definitionSentence({ ...definition, origin: "posted" })).toBe(
    "Failures are violations of any fault (any), of all oracles but observations: as defined where the runs were posted.",
  );
  expect(definitionSentence({ ...definition, origin: "request" })).toContain("as chosen here");
});

it("an address that names no such word leaves what was defined", () => {
  expect(countedOf("any")).toBe("any");
  expect(countedOf("all")).toBeUndefined();
  expect(countedOf("")).toBeUndefined();
  expect(COUNTED_CHOICES[0]?.value).toBe("");
});
