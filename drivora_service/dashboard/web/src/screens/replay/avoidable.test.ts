import { expect, it } from "vitest";
import { avoidableUntilOf } from "./avoidable";

const evidence = { avoidability: { latest_before: 4.45, risk_perceived_before: 5.2 } };

it("a verdict says until when its violation could be avoided", () => {
  expect(avoidableUntilOf({ avoidable: "yes", time: 9.8, evidence })).toBeCloseTo(5.35);
  expect(avoidableUntilOf({ avoidable: "no", time: 9.8, evidence })).toBeNull();
  expect(avoidableUntilOf({ avoidable: "yes", time: null, evidence })).toBeNull();
  expect(avoidableUntilOf({ avoidable: "yes", time: 9.8, evidence: {} })).toBeNull();
  expect(
    avoidableUntilOf({ avoidable: "yes", time: 9.8, evidence: { avoidability: null } }),
  ).toBeNull();
});
