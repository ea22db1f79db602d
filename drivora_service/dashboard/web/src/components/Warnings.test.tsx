import { renderToStaticMarkup } from "react-dom/server";
import { expect, test } from "vitest";
import { Warnings } from "./Warnings";

test("runs without a result are listed with their reason", () => {
  const reason = "oracle close_share of the package broken-oracle raised NameError";
  const shown = renderToStaticMarkup(
    <Warnings
      warnings={[]}
      missing={[
        {
          cause: "plugin_raised",
          evaluation: 0,
          message: reason,
          runs: 6,
          status: "plugin_failed",
        },
        {
          cause: "agent_hung",
          evaluation: 3,
          message: "too slow",
          runs: 1,
          status: "agent_failed",
        },
      ]}
    />,
  );
  expect(shown).toContain(`<li>6 runs without a result: ${reason}</li>`);
  expect(shown).toContain("<li>1 run without a result: too slow</li>");
});

test("nothing is shown where nothing is to be said", () => {
  expect(renderToStaticMarkup(<Warnings warnings={[]} missing={[]} />)).toBe("");
});
