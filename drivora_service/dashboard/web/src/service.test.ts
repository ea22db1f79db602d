import { expect, it } from "vitest";
import { addressOf, rootOf } from "./service";

it("the address of a script says which path the service is under", () => {
  expect(rootOf("https://host/assets/index-a1.js")).toBe("");
  expect(rootOf("https://host/drivora/assets/index-a1.js")).toBe("/drivora");
  expect(rootOf("http://host:81/tools/assets/drivora/assets/hub.worker-b2.js")).toBe(
    "/tools/assets/drivora",
  );
});

it("sources are at the root of the development server", () => {
  expect(rootOf("http://127.0.0.1:5173/src/service.ts?t=1")).toBe("");
  expect(addressOf("/docs")).toBe("/docs");
});
