import { expect, it } from "vitest";
import { emptyDraft, withScenario, withSetting } from "./draft";
import { workOf } from "./work";

const scenario = (town: string) => ({
  label: town,
  origin: "of a file",
  document: { ego_vehicles: [{ agent: { name: "idm" } }], map_region: { town } },
});
const two = withScenario(withScenario([], scenario("tee-town")), scenario("grid"));

it("a campaign shares its simulations among its scenarios, with their ADS or its own", () => {
  const draft = { ...emptyDraft("campaign"), scenarios: two };
  expect(workOf("campaign", draft)).toEqual([
    { agent: "idm", town: "tee-town", simulations: 100 },
    { agent: "idm", town: "grid", simulations: 100 },
  ]);
  const nmpc = withSetting(draft, "/agent/name", "nmpc");
  expect(workOf("campaign", nmpc).map(({ agent }) => agent)).toEqual(["nmpc", "nmpc"]);
});

it("a study makes them for each scenario, ADS, method and repetition", () => {
  const draft = { ...emptyDraft("study"), scenarios: two };
  const more = withSetting(draft, "/agents", [{ name: "idm" }, { name: "nmpc" }]);
  const work = workOf("study", more);
  expect(work.map(({ agent, town }) => `${agent} ${town}`)).toEqual([
    "idm tee-town",
    "nmpc tee-town",
    "idm grid",
    "nmpc grid",
  ]);
  expect(work.map(({ simulations }) => simulations)).toEqual([600, 600, 600, 600]);
});

it("what is no number yet is no work", () => {
  const draft = { ...emptyDraft("campaign"), scenarios: two };
  expect(workOf("campaign", withSetting(draft, "/budget/simulations", "2x"))).toEqual([]);
});
