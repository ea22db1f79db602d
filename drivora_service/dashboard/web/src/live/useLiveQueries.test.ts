import { QueryClient } from "@tanstack/react-query";
import { expect, it } from "vitest";
import { renewTouched } from "./useLiveQueries";

it("waits for an answer that is on its way, and asks again after it", async () => {
  const queries = new QueryClient();
  let answer: (value: string) => void = () => {};
  const slow = queries.fetchQuery({
    queryKey: ["run", "list"],
    queryFn: () =>
      new Promise<string>((done) => {
        answer = done;
      }),
  });
  queries.setQueryData(["run", "a"], "old");
  queries.setQueryData(["batch", "b"], "old");
  const later = renewTouched(queries, new Set(["run list", "run a"]));
  expect([...later]).toEqual(["run list"]);
  expect(queries.getQueryState(["run", "a"])?.isInvalidated).toBe(true);
  expect(queries.getQueryState(["batch", "b"])?.isInvalidated).toBe(false);
  answer("made before the change");
  expect(await slow).toBe("made before the change");
  expect(renewTouched(queries, later).size).toBe(0);
  expect(queries.getQueryState(["run", "list"])?.isInvalidated).toBe(true);
});
it("asks for everything where what has changed cannot be told", () => {
  const queries = new QueryClient();
  queries.setQueryData(["study", "s"], "old");
  expect(renewTouched(queries, new Set(["everything"])).size).toBe(0);
  expect(queries.getQueryState(["study", "s"])?.isInvalidated).toBe(true);
});
