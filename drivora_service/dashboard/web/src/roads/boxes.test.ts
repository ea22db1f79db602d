import { expect, it } from "vitest";
import { outlineOf } from "./boxes";

const patch = { id: "ice", x: 10, y: 20, yaw: 0, length: 8, width: 2, friction: 0.2 };

it("an outline has the length along the heading and the width across it", () => {
  expect(outlineOf(patch)).toEqual([14, 21, 6, 21, 6, 19, 14, 19]);
  const turned = outlineOf({ ...patch, yaw: Math.PI / 2 }).map((value) => Math.round(value));
  expect(turned).toEqual([9, 24, 9, 16, 11, 16, 11, 24]);
});
