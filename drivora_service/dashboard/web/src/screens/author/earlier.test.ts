import { expect, it } from "vitest";
import { wordsOf } from "./earlier";
import { emptyScenario, withActor } from "./scenario";

it("an earlier scenario is named by its network, its actors and when it was left", () => {
  const [scenario] = withActor(emptyScenario("tee-town"), "npc_walkers", [{ x: 1, y: 2 }]);
  const at = "2026-11-26T22:49:35.364Z";
  expect(wordsOf({ at, scenario })).toBe("tee-town, 1 actor, 2026-11-26 22:49");
  const origin = { label: "cut in", run: "7" };
  expect(wordsOf({ at, scenario, origin, isEdited: true })).toBe(
    "cut in, edited, 1 actor, 2026-11-26 22:49",
  );
});
