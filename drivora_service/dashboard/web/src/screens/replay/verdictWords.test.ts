import { describe, expect, it } from "vitest";
import {
  alike,
  artefactsOf,
  blameWords,
  failuresOf,
  followingWords,
  gravestFirst,
  observedWords,
  oracleName,
  toneOf,
  untilWords,
} from "./verdictWords";

describe("words of a violation", () => {
  it.each([
    [{ at_fault: true, avoidable: "yes" }, 7.4, "at fault, avoidable until 7.40 s"],
    [{ at_fault: true, avoidable: "yes" }, null, "at fault, avoidable"],
    [{ at_fault: true, avoidable: "yes" }, 0, "at fault, avoidable until 0.00 s"],
    [{ at_fault: true, avoidable: "no" }, null, "at fault, not avoidable"],
    [{ at_fault: false, avoidable: "no" }, null, "not at fault, not avoidable"],
    [
      { at_fault: true, avoidable: "not_measurable" },
      null,
      "at fault, avoidable or not: not measurable",
    ],
    [{ at_fault: null, avoidable: null, undetermined: true }, null, "fault undetermined"],
    [{ at_fault: null, avoidable: null, undetermined: false }, null, ""],
    [{ at_fault: true, avoidable: null }, null, "at fault"],
  ] as const)("%o until %o", (violation, until, words) => {
    expect(blameWords(violation, until)).toBe(words);
  });
  it("tell a moment that came too early from one that was missed", () => {
    const collision = { oracle: "collision" };
    expect(untilWords({ ...collision, avoidable: "yes" }, 7.4)).toBe(
      "Collision: avoidable until 7.40 s",
    );
    expect(untilWords({ ...collision, avoidable: "no" }, 5.65)).toContain("had to act by 5.65 s");
  });
  it("count observations", () => {
    expect([1, 3].map(observedWords)).toEqual(["1 observation", "3 observations"]);
  });
  it("name oracles", () => {
    expect(oracleName("red_light")).toBe("Red light");
  });
});

it.each([
  ["major", true, "bad"],
  ["minor", true, "bad"],
  ["major", false, "lost"],
  ["major", null, "lost"],
  ["observation", true, "quiet"],
  ["observation", null, "quiet"],
] as const)("a %s violation with fault %s looks %s", (severity, at_fault, tone) => {
  expect(toneOf({ severity, at_fault })).toBe(tone);
});

const verdict = (
  oracle: string,
  severity: "major" | "minor" | "observation",
  at_fault: boolean | null,
  time: number,
) => ({
  oracle,
  severity,
  at_fault,
  time,
  ego: "e",
  outcome: "violated" as const,
  message: "",
  undetermined: false,
  avoidable: null,
  physically_avoidable: null,
  step: 0,
  location: null,
  counterpart: "",
  evidence: {},
  follows: "",
});

it("the gravest violation comes first, observations last", () => {
  const sorted = gravestFirst([
    verdict("discomfort", "observation", null, 0),
    verdict("speeding", "minor", null, 1),
    verdict("collision", "major", false, 2),
    verdict("red_light", "major", true, 9),
    verdict("off_road", "major", true, 8),
  ]);
  expect(sorted.map(({ oracle }) => oracle)).toEqual([
    "off_road",
    "red_light",
    "collision",
    "speeding",
    "discomfort",
  ]);
});

it("what counts comes first, and what only follows behind its cause", () => {
  const missed = { ...verdict("destination", "minor", null, 9), follows: "collision" };
  const [slow, hit] = [
    verdict("speeding", "minor", null, 1),
    verdict("collision", "major", false, 9),
  ];
  expect(gravestFirst([missed, slow, hit])).toEqual([hit, slow, missed]);
  expect(gravestFirst([missed, hit, slow], [slow])).toEqual([slow, hit, missed]);
  expect(failuresOf({ verdicts: [missed, slow], failing_verdicts: [1] })).toEqual([slow]);
  expect(followingWords([missed])).toBe("1 that follows: destination");
});

it("a collision comes before an earlier violation that did no harm", () => {
  const sorted = gravestFirst([
    verdict("stop_sign", "major", true, 3),
    verdict("collision", "major", true, 9),
  ]);
  expect(sorted[0]?.oracle).toBe("collision");
});

it("an artefact of the simulator differs from what else is not measurable", () => {
  const unclear = {
    ...verdict("destination", "minor", null, 4),
    outcome: "not_measurable",
  } as const;
  const artefact = { ...unclear, oracle: "collision", evidence: { artefact: "jumped" } } as const;
  expect(artefactsOf([verdict("collision", "major", false, 4), unclear, artefact])).toEqual([
    artefact,
  ]);
});

it("violations of one oracle are gathered at the first of them", () => {
  const one = verdict("stop_sign", "major", true, 3);
  const other = verdict("deadlock", "minor", null, 4);
  expect(alike([one, other, verdict("stop_sign", "major", true, 5)])).toEqual([
    { first: one, count: 2 },
    { first: other, count: 1 },
  ]);
});

it("of two collisions at fault, the one that was avoidable comes first", () => {
  const unavoidable = { ...verdict("collision", "major", true, 3), avoidable: "no" } as const;
  const avoidable = { ...verdict("collision", "major", true, 9), avoidable: "yes" } as const;
  expect(gravestFirst([unavoidable, avoidable])[0]?.time).toBe(9);
});
