import { expect, it } from "vitest";
import { choicesOf, originOf, pastedId, repeatLabel } from "./compareChoices";

const run = (id: string, scenario: string, label = "", trace = "t") => ({
  id,
  label,
  configuration: "idm",
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

it("the run that is repeated comes first of its scenario", () => {
  const origin = run("a-1", "s");
  const mine = run("mine", "s", repeatLabel("a-1"));
  expect(originOf(mine)).toBe("a-1");
  expect(originOf(origin)).toBe("");
  expect(choicesOf(mine, [run("b", "s"), origin], []).scenario[0]).toBe(origin);
});

it("runs are found by words of their label, their id or their ADS", () => {
  const left = run("one", "x", "Left turn at a light");
  const right = run("two", "y", "Right turn");
  const found = (words: string) => choicesOf(run("mine", "s"), [], [left, right], words).network;
  expect(found("turn left")).toEqual([left]);
  expect(found("TWO")).toEqual([right]);
  expect(found("idm")).toEqual([left, right]);
  expect(found("none")).toEqual([]);
});

it("a pasted id may be of any run: of a campaign, a second one, or of a minimisation", () => {
  const id = "01a21b4a44af52ab832b4b8d";
  for (const one of [id, `${id}-12`, `${id}-12-again`, `${id}-d0101d3b2ae719c`]) {
    expect(pastedId(` ${one} `)).toBe(one);
    expect(pastedId(`http://localhost:8000/runs/${one}?t=3.2`)).toBe(one);
  }
  expect(pastedId("left turn")).toBe("");
});
