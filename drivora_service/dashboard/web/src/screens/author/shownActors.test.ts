import { expect, it } from "vitest";
import type { Schemas } from "../../api/client";
import { planeOf } from "./plane";
import { actorNear, shownActors, takesDetour } from "./shownActors";

const PLANE = planeOf("sumo", undefined);
const MODELS = new Map([["vehicle car", { length: 4, width: 1.8 }]]);
const SCENARIO = {
  ego_vehicles: [
    {
      id: "ego",
      model: "car",
      route: [
        { x: 0, y: 0 },
        { x: 0, y: 50 },
      ],
    },
  ],
  npc_obstacles: [{ id: "box", model: "?", location: { x: 20, y: 0, yaw: 90 }, length: 3 }],
  friction_patches: [{ id: "ice", location: { x: 0, y: 0 }, length: 30, width: 6, friction: 0.1 }],
};
const inspection = (
  problems: readonly string[],
  actors: readonly Partial<Schemas["InspectedActor"]>[],
): Schemas["Inspection"] => ({
  valid: problems.length === 0,
  town: "tee-town",
  problems: problems.map((pointer) => ({ pointer, code: "odd", message: "odd" })),
  notes: [],
  actors: actors as Schemas["InspectedActor"][],
});

it("before the service answers, actors stand as the document says", () => {
  const [ego, box, ice] = shownActors(SCENARIO, PLANE, MODELS, undefined);
  expect(ego).toMatchObject({ x: 0, y: 0, length: 4, width: 1.8, path: [], row: 0 });
  expect(ego?.yaw).toBeCloseTo(Math.PI / 2);
  expect(box).toMatchObject({ length: 3, width: 1.5 });
  expect(box?.yaw).toBeCloseTo(Math.PI / 2);
  expect(ice).toMatchObject({ friction: 0.1, length: 30, width: 6 });
});

it("ways and headings are those of the service, problems mark their actor", () => {
  const told = inspection(
    ["/npc_obstacles/0/model", "/weather/wetness"],
    [
      {
        pointer: "/ego_vehicles/0",
        id: "ego",
        yaw: 1.2,
        path: [
          [0, 0],
          [0, 50],
        ],
        path_length: 50,
      },
    ],
  );
  const [ego, box] = shownActors(SCENARIO, PLANE, MODELS, told);
  expect(ego).toMatchObject({ yaw: 1.2, path: [0, 0, 0, 50], pathLength: 50, hasProblem: false });
  expect(box?.hasProblem).toBe(true);
});

it("a way much longer than the lines between its places is a detour", () => {
  const driven = (metres: number) => {
    const told = inspection(
      [],
      [{ pointer: "/ego_vehicles/0", id: "ego", yaw: 0, path: [], path_length: metres }],
    );
    const [ego] = shownActors(SCENARIO, PLANE, MODELS, told);
    return ego && takesDetour(ego);
  };
  expect([driven(0), driven(60), driven(149), driven(160)]).toEqual([false, false, false, true]);
});

it("what the service said of another actor at the same place of the list is not shown", () => {
  const told = inspection([], [{ pointer: "/ego_vehicles/0", id: "other", yaw: 1.2, path: [] }]);
  expect(shownActors(SCENARIO, PLANE, MODELS, told)[0]?.yaw).toBeCloseTo(Math.PI / 2);
});

it("the actor under the pointer is found; a patch lies under what stands on it", () => {
  const actors = shownActors(SCENARIO, PLANE, MODELS, undefined);
  expect(actorNear(actors, 0.5, 1, 1)?.id).toBe("ego");
  expect(actorNear(actors, 12, 1, 1)?.id).toBe("ice");
  expect(actorNear(actors, 20.5, 2, 1)?.id).toBe("box");
  expect(actorNear(actors, 60, 60, 1)).toBeUndefined();
});
