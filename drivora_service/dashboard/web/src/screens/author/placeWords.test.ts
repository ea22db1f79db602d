import { expect, it } from "vitest";
import { placeWords } from "./placeWords";

const SCENARIO = { npc_vehicles: [{ id: "van_2" }, { model: "m" }] };

it("a place is named by the actor's id and the rest of the way to it", () => {
  expect(placeWords(SCENARIO, "/npc_vehicles/0/route/2")).toBe("van_2 place 2");
  expect(placeWords(SCENARIO, "/npc_vehicles/0/route/2/speed")).toBe("van_2 place 2 speed");
  expect(placeWords(SCENARIO, "/npc_vehicles/0/start_time")).toBe("van_2 start time");
  expect(placeWords(SCENARIO, "/npc_vehicles/1/model")).toBe("vehicle 1 model");
});

it("what belongs to no actor is named by its keys", () => {
  expect(placeWords(SCENARIO, "/map_region/town")).toBe("map region town");
  expect(placeWords(SCENARIO, "")).toBe("scenario");
});
