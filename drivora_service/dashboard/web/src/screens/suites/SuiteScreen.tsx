import { useQuery } from "@tanstack/react-query";
import { Link, useNavigate } from "@tanstack/react-router";
import { firstOf, type Search } from "../../address";
import { api, body } from "../../api/client";
import { Filters } from "../../components/Filters";
import { Mark } from "../../components/Mark";
import { Loading, Refused } from "../../components/States";
import { useTitle } from "../../shell/useTitle";
import { Changes } from "./Changes";
import { Squares } from "./Squares";
import {
  changeSentence,
  changesBetween,
  comparedRuns,
  lookOfGate,
  runNames,
  shareWords,
} from "./suite";
import { Trend } from "./Trend";
import { useDrivers } from "./useDrivers";
import "./suites.css";

const RUNS = 30;

/** A suite: what its gate decided last and why, its trend, and the history of its scenarios. */
export function SuiteScreen({
  suite,
  search,
}: {
  readonly suite: string;
  readonly search: Search;
}) {
  useTitle(suite);
  const navigate = useNavigate();
  const agent = firstOf(search, "agent");
  const configuration = firstOf(search, "configuration");
  const drivers = useDrivers(suite);
  const query = useQuery({
    queryKey: ["suite", "list", suite, agent, configuration],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/suites:history", {
          params: {
            query: {
              suite,
              runs: RUNS,
              ...(agent ? { agent } : {}),
              ...(configuration ? { configuration } : {}),
            },
          },
        }),
      ),
  });
  const history = query.data;
  const last = history?.runs.at(-1);
  const [before, after] = history
    ? comparedRuns(
        { before: firstOf(search, "before"), after: firstOf(search, "after") },
        history.runs,
      )
    : [-1, -1];
  const names = runNames(history?.runs ?? []);
  const changes = history && before >= 0 ? changesBetween(history, before, after) : undefined;
  const choose = (chosen: { readonly before?: string; readonly after?: string }) =>
    void navigate({
      to: ".",
      search: { ...search, ...chosen },
      replace: true,
      resetScroll: false,
    });
  return (
    <>
      <div className="head">
        <h1>{suite}</h1>
        <p className="answer">
          <Link to="/suites" search={{}}>
            All suites
          </Link>
          {last && (
            <>
              {" › "}
              <Mark {...lookOfGate(last)} /> {names.at(-1)?.whole}: {shareWords(last.pass_rate)} of
              the scenarios pass.
            </>
          )}
        </p>
      </div>
      <Filters filters={drivers} search={search} />
      {query.isPending && <Loading rows={12} />}
      {query.isError && <Refused error={query.error} onRepeat={() => void query.refetch()} />}
      {history && last && (
        <>
          <section className="panel decision" aria-label="The last decision">
            <p>{last.sentence}.</p>
            {last.reasons.length > 0 && (
              <ul>
                {last.reasons.map((reason) => (
                  <li key={reason}>{reason}</li>
                ))}
              </ul>
            )}
            <p className="quiet">
              {last.baseline ? `Baseline ${last.baseline}` : "Without a baseline"}
              {changes &&
                `; ${after === history.runs.length - 1 ? "since" : `${names[after]?.whole} since`} ${names[before]?.whole}: ${changeSentence(changes)}`}
            </p>
          </section>
          <Trend history={history} names={names} />
          <Squares
            history={history}
            names={names}
            before={before}
            after={after}
            onChoose={choose}
          />
          {changes && <Changes names={names} before={before} after={after} changes={changes} />}
        </>
      )}
    </>
  );
}
