import { expect, it } from "vitest";
import { choicesOf } from "./compareChoices";

const run = (id: string, scenario: string, label = "", trace = "t") => ({
  id,
  label,
  scenario_sha256: scenario,
  trace_sha256: trace,
});

it("runs of the scenario come first, then those of the network, of the same name before others", () => {
  const mine = run("mine", "s", "Crossing");
  const again = run("again", "s", "Crossing");
  const other = run("other", "x");
  const named = run("named", "y", "Crossing");
  const found = choicesOf(
    mine,
    [mine, again, run("pruned", "s", "", "")],
    [mine, other, again, named],
  );
  expect(found).toEqual({ scenario: [again], network: [named, other] });
});
