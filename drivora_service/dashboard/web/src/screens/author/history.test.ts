import { expect, it } from "vitest";
import { type HistoryAction, historyOf, nextHistory } from "./history";

const document = (seed: number) => ({ seed });
const done = (...actions: HistoryAction[]) => actions.reduce(nextHistory, historyOf(document(0)));
const change = (seed: number, of = ""): HistoryAction => ({
  do: "change",
  to: document(seed),
  of,
});

it("goes back and forward again", () => {
  const both = done(change(1), change(2), { do: "undo" }, { do: "undo" });
  expect(both.now).toEqual(document(0));
  expect(nextHistory(both, { do: "undo" })).toBe(both);
  const again = nextHistory(both, { do: "redo" });
  expect(again.now).toEqual(document(1));
  expect(nextHistory(again, { do: "redo" }).now).toEqual(document(2));
});

it("changes of the same thing are one step back", () => {
  const typed = done(change(1, "/seed"), change(12, "/seed"), change(123, "/seed"));
  expect(nextHistory(typed, { do: "undo" }).now).toEqual(document(0));
  const other = done(change(1, "/seed"), change(2, "/weather"), change(3, "/seed"));
  expect(nextHistory(other, { do: "undo" }).now).toEqual(document(2));
});

it("what is changed after a step back has no way forward", () => {
  const changed = done(change(1), { do: "undo" }, change(5));
  expect(nextHistory(changed, { do: "redo" })).toBe(changed);
});

it("another document that was opened can be left by a step back", () => {
  const opened = done(change(1), { do: "open", document: document(9) });
  expect(nextHistory(opened, { do: "undo" }).now).toEqual(document(1));
});
