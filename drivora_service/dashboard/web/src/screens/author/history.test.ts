import { expect, it } from "vitest";
import { type HistoryAction, historyOf, nextHistory } from "./history";

const document = (seed: number) => ({ seed });
const opened = (seed: number, label = "cut in") => ({
  document: document(seed),
  origin: { label, run: "7" },
  isEdited: false,
});
const done = (...actions: HistoryAction[]) => actions.reduce(nextHistory, historyOf(opened(0)));
const change = (seed: number, of = ""): HistoryAction => ({
  do: "change",
  to: document(seed),
  of,
});

it("goes back and forward again", () => {
  const both = done(change(1), change(2), { do: "undo" }, { do: "undo" });
  expect(both.now.document).toEqual(document(0));
  expect(nextHistory(both, { do: "undo" })).toBe(both);
  const again = nextHistory(both, { do: "redo" });
  expect(again.now.document).toEqual(document(1));
  expect(nextHistory(again, { do: "redo" }).now.document).toEqual(document(2));
});

it("changes of the same thing are one step back", () => {
  const typed = done(change(1, "/seed"), change(12, "/seed"), change(123, "/seed"));
  expect(nextHistory(typed, { do: "undo" }).now.document).toEqual(document(0));
  const other = done(change(1, "/seed"), change(2, "/weather"), change(3, "/seed"));
  expect(nextHistory(other, { do: "undo" }).now.document).toEqual(document(2));
});

it("what is changed after a step back has no way forward", () => {
  const changed = done(change(1), { do: "undo" }, change(5));
  expect(nextHistory(changed, { do: "redo" })).toBe(changed);
});

it("what was opened is edited from the first change on, and not after it was taken back", () => {
  const changed = done(change(1));
  expect(changed.now).toMatchObject({ origin: { label: "cut in" }, isEdited: true });
  expect(nextHistory(changed, { do: "undo" }).now.isEdited).toBe(false);
});

it("what has been opened has nothing to undo", () => {
  expect(done(change(1), { do: "open", written: opened(9) }).past).toEqual([]);
});

it("another document that takes its place can be left by a step back", () => {
  const replaced = done(change(1), { do: "replace", written: opened(9, "rain") });
  expect(replaced.now.origin?.label).toBe("rain");
  const back = nextHistory(replaced, { do: "undo" });
  expect(back.now).toMatchObject({ document: document(1), origin: { label: "cut in" } });
});
