import { expect, it } from "vitest";
import { groupText, kindText, wordsOfKind } from "./words";

it("kinds are read as oracle, place and relation", () => {
  const kind = "collision|road eb_1|npc_vehicle, front";
  expect(wordsOfKind(kind)).toEqual({
    oracle: "collision",
    place: "road eb_1",
    relation: "npc vehicle, front",
  });
  expect(kindText(kind)).toBe("collision · npc vehicle, front · road eb_1");
  expect(kindText("red_light|junction a|")).toBe("red light · junction a");
});
it("groups are read on one line", () => {
  expect(groupText("collision|npc_vehicle, front|following")).toBe(
    "collision · npc vehicle, front · following",
  );
});
