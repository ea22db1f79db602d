import { expect, it } from "vitest";
import { estimated } from "./estimate";

const known = [
  { agent: "idm", town: "tee-town", rate: 4 },
  { agent: "idm", town: "tee-town", rate: 6 },
  { agent: "idm", town: "grid", rate: 1 },
];
const work = (agent: string, town: string) => ({ agent, town, simulations: 100 });

it("uses the median of the same network, and others only without one", () => {
  expect(estimated([work("idm", "tee-town")], known)).toEqual({ seconds: 20, campaigns: 2 });
  expect(estimated([work("idm", "elsewhere")], known)).toEqual({ seconds: 25, campaigns: 3 });
});

it("adds up work, and is none if any of it is not known", () => {
  const both = [work("idm", "tee-town"), work("idm", "grid")];
  expect(estimated(both, known)).toEqual({ seconds: 120, campaigns: 3 });
  expect(estimated([...both, work("nmpc", "grid")], known)).toBeUndefined();
  expect(estimated([], known)).toBeUndefined();
});
