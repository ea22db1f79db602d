import { useQuery } from "@tanstack/react-query";
import { Link, useNavigate } from "@tanstack/react-router";
import { firstOf, type Search } from "../../address";
import { api, body } from "../../api/client";
import { Filters } from "../../components/Filters";
import { Mark } from "../../components/Mark";
import { moment } from "../../components/numbers";
import { Loading, Refused } from "../../components/States";
import { useTitle } from "../../shell/useTitle";
import { Changes } from "./Changes";
import { Squares } from "./Squares";
import { changeSentence, changesBetween, driverOf, lookOfGate, shareWords } from "./suite";
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
  const drivers = useDrivers(suite);
  const query = useQuery({
    queryKey: ["suite", "list", suite, agent],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/suites:history", {
          params: { query: { suite, runs: RUNS, ...(agent ? { agent } : {}) } },
        }),
      ),
  });
  const history = query.data;
  const last = history?.runs.at(-1);
  const [before, after] = history ? chosenRuns(search, history.runs) : [-1, -1];
  const changes = history && before >= 0 ? changesBetween(history, before, after) : undefined;
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
              <Mark {...lookOfGate(last)} /> {moment(last.created_at).slice(0, 16)},{" "}
              {driverOf(last)}: {shareWords(last.pass_rate)} of the scenarios pass.
            </>
          )}
        </p>
      </div>
      <Filters filters={[drivers]} search={search} />
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
              {changes && `; since the run before it: ${changeSentence(changes)}`}
            </p>
          </section>
          <Trend history={history} />
          <Squares
            history={history}
            chosen={before >= 0 ? [before, after] : []}
            onChoose={(run) =>
              void navigate({
                to: ".",
                search: { ...search, before: run },
                replace: true,
              })
            }
          />
          {changes && <Changes history={history} before={before} after={after} changes={changes} />}
        </>
      )}
    </>
  );
}

/** Returns the places of the two runs that are compared: the last, and one before it. */
function chosenRuns(
  search: Search,
  runs: readonly { readonly id: string }[],
): readonly [number, number] {
  const after = runs.length - 1;
  const asked = runs.findIndex(({ id }) => id === firstOf(search, "before"));
  return [asked >= 0 && asked < after ? asked : after - 1, after];
}
