import { expect, it } from "vitest";
import { adsHint, configurationFilter } from "./configuration";
import { offered, wordsFor } from "./filterValues";

it("an ADS is shown with its id, unless that was not recorded", () => {
  expect(adsHint({ configuration: "idm", configuration_id: "1234abcd" })).toBe("idm (1234abcd)");
  expect(adsHint({ configuration: "idm", configuration_id: "" })).toBe("idm");
});

it("two configurations of one ADS are two values of the filter, named by their words", () => {
  const filter = configurationFilter([
    { id: "aaaaaaaa", words: "idm", runs: 2 },
    { id: "bbbbbbbb", words: "idm · reaction_time 1.0", runs: 3 },
  ]);
  expect(offered(filter, [])).toEqual(["bbbbbbbb", "aaaaaaaa"]);
  expect(wordsFor(filter, "bbbbbbbb")).toBe("idm · reaction_time 1.0");
});
