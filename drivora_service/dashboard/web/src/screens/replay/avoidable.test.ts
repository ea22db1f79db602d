import { expect, it } from "vitest";
import { avoidableUntil } from "./avoidable";

const evidence = { avoidability: { latest_before: 4.45, risk_perceived_before: 5.2 } };

it("a verdict says until when its violation could be avoided", () => {
  expect(avoidableUntil({ avoidable: "yes", time: 9.8, evidence })).toBeCloseTo(5.35);
  expect(avoidableUntil({ avoidable: "no", time: 9.8, evidence })).toBeNull();
  expect(avoidableUntil({ avoidable: "yes", time: null, evidence })).toBeNull();
  expect(avoidableUntil({ avoidable: "yes", time: 9.8, evidence: {} })).toBeNull();
  expect(
    avoidableUntil({ avoidable: "yes", time: 9.8, evidence: { avoidability: null } }),
  ).toBeNull();
});
