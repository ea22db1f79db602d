import { expect, it } from "vitest";
import type { Schemas } from "../../../api/client";
import { placesOf } from "./failurePlaces";

function failure(evaluation: number, verdict: Partial<Schemas["Verdict"]>): Schemas["Failure"] {
  const kind = "collision|road a|";
  const urls = { observations_url: "", scenario_url: "", trace: "" };
  const whole = { oracle: "collision", ego: "ego_0", message: "", counterpart: "" } as const;
  const rest = {
    outcome: "violated",
    severity: "major",
    undetermined: false,
    follows: "",
  } as const;
  return {
    evaluation,
    kind,
    place: 0,
    confirmation: "open",
    ...urls,
    verdict: { ...whole, ...rest, ...verdict },
  };
}

it("failures have a place on the network of their evaluation, unless none was recorded", () => {
  const places = placesOf(
    [
      failure(3, { location: [1, 2], at_fault: true, avoidable: "yes" }),
      failure(4, { location: null }),
      failure(5, { location: [7, 8], at_fault: true, avoidable: "no" }),
    ],
    (evaluation) => (evaluation === 3 ? "tee-town" : "highway"),
  );
  expect(places.map(({ x, y, town, isAvoidable }) => [x, y, town, isAvoidable])).toEqual([
    [1, 2, "tee-town", true],
    [7, 8, "highway", false],
  ]);
});
