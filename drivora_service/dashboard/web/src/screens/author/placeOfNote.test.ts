import { expect, it } from "vitest";
import { placeOfNote } from "./placeOfNote";

it("a note with a pointer has a place and words", () => {
  expect(placeOfNote("/ego_vehicles/0/initial_speed: ego 'a' starts at 50 m/s: too fast")).toEqual({
    pointer: "/ego_vehicles/0/initial_speed",
    words: "ego 'a' starts at 50 m/s: too fast",
  });
});

it("a note without one keeps all its words", () => {
  const note = "ego 'hero': waypoint 2 at (3, 4) is left out";
  expect(placeOfNote(note)).toEqual({ pointer: "", words: note });
  expect(placeOfNote("/ is no place")).toEqual({ pointer: "", words: "/ is no place" });
});
