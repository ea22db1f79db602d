import { expect, it } from "vitest";
import type { JsonObject } from "../../components/fields/pointers";
import {
  actorOf,
  actorsOf,
  emptyScenario,
  noActorYet,
  withActor,
  withCopy,
  without,
  withPlaceMoved,
  withWaypoint,
} from "./scenario";

const place = (x: number, y: number) => ({ x, y });

function twoActors(): JsonObject {
  const [ego, pointer] = withActor(emptyScenario("tee-town"), "ego_vehicles", [place(1, 2)]);
  const driven = withWaypoint(ego, pointer, { ...place(30, 2), yaw: 0 });
  return withActor(driven, "npc_walkers", [place(5, 5)])[0];
}

it("actors are added with ids of their own, and found with their places", () => {
  const [scenario] = withActor(twoActors(), "npc_walkers", [place(7, 7)]);
  const actors = actorsOf(scenario);
  expect(actors.map(({ pointer, id }) => [pointer, id])).toEqual([
    ["/ego_vehicles/0", "ego"],
    ["/npc_walkers/0", "walker"],
    ["/npc_walkers/1", "walker-2"],
  ]);
  expect(actors[0]?.places).toEqual([
    { pointer: "/ego_vehicles/0/route/0", x: 1, y: 2, yaw: undefined },
    { pointer: "/ego_vehicles/0/route/1", x: 30, y: 2, yaw: 0 },
  ]);
  expect(actors[0]?.model).toMatch(/^vehicle\./);
});

it("obstacles and patches stand at one place", () => {
  const [one] = withActor(emptyScenario("t"), "npc_obstacles", [place(3, 4)]);
  const [two] = withActor(one, "friction_patches", [place(8, 9)]);
  expect(actorsOf(two).map(({ places }) => places)).toEqual([
    [{ pointer: "/npc_obstacles/0/location", x: 3, y: 4, yaw: undefined }],
    [{ pointer: "/friction_patches/0/location", x: 8, y: 9, yaw: undefined }],
  ]);
  expect(actorsOf(two)[1]).toMatchObject({ length: 20, width: 8, model: "" });
});

it("what is malformed is passed over", () => {
  const scenario = {
    ego_vehicles: [3, { id: 7, model: "m", route: [{ x: "1", y: 2 }, { x: 1, y: 2 }, null] }],
    npc_walkers: { x: 1 },
  };
  expect(actorsOf(scenario)).toEqual([
    {
      pointer: "/ego_vehicles/1",
      list: "ego_vehicles",
      id: "",
      model: "m",
      places: [{ pointer: "/ego_vehicles/1/route/1", x: 1, y: 2, yaw: undefined }],
      length: undefined,
      width: undefined,
    },
  ]);
});

it("a moved place keeps what else it says; a heading follows the lane where there was one", () => {
  const scenario = { ego_vehicles: [{ route: [{ x: 1, y: 2, yaw: 90, speed: 3 }, place(4, 5)] }] };
  const moved = withPlaceMoved(scenario, "/ego_vehicles/0/route/0", { x: 8, y: 9, yaw: -5 });
  const both = withPlaceMoved(moved, "/ego_vehicles/0/route/1", { x: 6, y: 7, yaw: -5 });
  expect(both).toEqual({
    ego_vehicles: [{ route: [{ x: 8, y: 9, yaw: -5, speed: 3 }, place(6, 7)] }],
  });
});

it("what is removed leaves no empty list, but the egos'", () => {
  const scenario = twoActors();
  expect(without(scenario, "/npc_walkers/0")).not.toHaveProperty("npc_walkers");
  expect(without(scenario, "/ego_vehicles/0")).toMatchObject({ ego_vehicles: [] });
  const shorter = without(scenario, "/ego_vehicles/0/route/1");
  expect(actorsOf(shorter)[0]?.places).toHaveLength(1);
  // An actor without places is no actor.
  expect(without(shorter, "/ego_vehicles/0/route/0")).toMatchObject({ ego_vehicles: [] });
});

it("a copy has another id", () => {
  const [scenario, pointer] = withCopy(twoActors(), "/ego_vehicles/0");
  expect(pointer).toBe("/ego_vehicles/1");
  const [first, second] = actorsOf(scenario);
  expect(second).toMatchObject({ id: "ego-2", model: first?.model });
  expect(second?.places.map(({ x }) => x)).toEqual(first?.places.map(({ x }) => x));
});

it("a place of the document belongs to its actor, or to none", () => {
  expect(actorOf("/npc_vehicles/3/route/1/x")).toBe("/npc_vehicles/3");
  expect(actorOf("/npc_vehicles")).toBe("");
  expect(actorOf("/weather/wetness")).toBe("");
  expect(actorOf("")).toBe("");
});

it("a list of actors without one is told apart from a place in it", () => {
  const empty = emptyScenario("tee-town");
  expect(noActorYet(empty, "/ego_vehicles")).toBe("ego_vehicles");
  expect(noActorYet(empty, "/map_region/town")).toBeUndefined();
  expect(noActorYet(twoActors(), "/ego_vehicles")).toBeUndefined();
  expect(noActorYet(twoActors(), "/ego_vehicles/0")).toBeUndefined();
});
