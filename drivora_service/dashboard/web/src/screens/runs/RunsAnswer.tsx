import { Link } from "@tanstack/react-router";
import type { Search } from "../../address";
import type { Schemas } from "../../api/client";
import { count } from "../../components/numbers";
import { NOT_JUDGED } from "./status";

/** How things stand with the runs of the filter; each number leads to its runs. */
export function RunsAnswer({
  counts,
  search,
}: {
  readonly counts: Schemas["RunCounts"];
  readonly search: Search;
}) {
  const notJudged = NOT_JUDGED.reduce((sum, status) => sum + (counts.status[status] ?? 0), 0);
  const waiting = (counts.status.queued ?? 0) + (counts.status.running ?? 0);
  const parts: readonly { words: string; number: number; adds: Search }[] = [
    { words: "with an ego at fault", number: counts.at_fault, adds: { at_fault: "true" } },
    {
      words: "with violations, no ego at fault",
      number: counts.not_at_fault,
      adds: { at_fault: "false" },
    },
    { words: "passed", number: counts.not_violated, adds: { violated: "false" } },
    { words: "not judged", number: notJudged, adds: { status: NOT_JUDGED } },
    {
      words: "cancelled",
      number: counts.status.cancelled ?? 0,
      adds: { status: "cancelled" },
    },
    { words: "waiting or running", number: waiting, adds: { status: ["queued", "running"] } },
  ];
  return (
    <p className="answer" role="status">
      <strong>{count(counts.total)}</strong> {counts.total === 1 ? "run" : "runs"}
      {parts.map(({ words, number, adds }) =>
        // Counts of what is filtered already are those without that filter.
        number > 0 && !["oracle", ...Object.keys(adds)].some((name) => name in search) ? (
          <span key={words}>
            {" · "}
            {number < counts.total ? (
              <Link to="/runs" search={{ ...search, ...adds }}>
                {count(number)} {words}
              </Link>
            ) : (
              `all ${words}`
            )}
          </span>
        ) : null,
      )}
    </p>
  );
}
