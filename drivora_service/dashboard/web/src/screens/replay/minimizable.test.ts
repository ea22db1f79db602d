import { expect, it } from "vitest";
import type { Schemas } from "../../api/client";
import { minimizable } from "./minimizable";

const violation = (oracle: string, part: Partial<Schemas["Verdict"]>) =>
  ({
    oracle,
    ego: "ego",
    outcome: "violated",
    severity: "major",
    time: 3,
    follows: "",
    ...part,
  }) as Schemas["Verdict"];

const LATE = violation("collision", { at_fault: true, severity: "critical", time: 9 });
const EARLY = violation("collision", { at_fault: true, severity: "critical", time: 4 });
const SLOW = violation("destination", { at_fault: null, severity: "minor" });
const NEAR = violation("near_miss", { at_fault: true, severity: "observation" });

const id = "01a215ff5460f2a66a7526da";

it("the gravest violation of each oracle can be followed, the gravest first", () => {
  const verdicts = [SLOW, LATE, NEAR, EARLY];
  const failing_verdicts = [1, 3];
  expect(minimizable({ id, status: "finished", verdicts, failing_verdicts })).toEqual([
    EARLY,
    SLOW,
  ]);
});
it("what counts comes before what is graver and does not", () => {
  const verdicts = [SLOW, LATE];
  expect(minimizable({ id, status: "finished", verdicts, failing_verdicts: [0] })).toEqual([
    SLOW,
    LATE,
  ]);
});
it("without a failure, or before the end, there is none", () => {
  const verdicts = [SLOW, NEAR];
  expect(minimizable({ id, status: "finished", verdicts, failing_verdicts: [] })).toEqual([]);
  expect(minimizable({ id, status: "running", verdicts: [], failing_verdicts: [] })).toEqual([]);
});
it("a run of a minimisation leads to it instead", () => {
  const made = `${id}-81f16c3e97bd4fr`;
  expect(
    minimizable({ id: made, status: "finished", verdicts: [EARLY], failing_verdicts: [0] }),
  ).toEqual([]);
});
