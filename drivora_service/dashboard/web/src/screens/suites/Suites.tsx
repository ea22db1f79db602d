import { useQuery } from "@tanstack/react-query";
import { Link, useSearch } from "@tanstack/react-router";
import { firstOf } from "../../address";
import { api, body } from "../../api/client";
import { Mark } from "../../components/Mark";
import { count, moment } from "../../components/numbers";
import { Empty, Loading, Refused } from "../../components/States";
import { serviceAddress } from "../../service";
import { useTitle } from "../../shell/useTitle";
import { SuiteScreen } from "./SuiteScreen";
import { driverOf, lookOfGate, shareWords } from "./suite";

/** All suites that were run, or one of them. */
export function Suites() {
  const search = useSearch({ from: "/suites" });
  const suite = firstOf(search, "suite");
  return suite ? <SuiteScreen suite={suite} search={search} /> : <SuiteList />;
}

function SuiteList() {
  useTitle("Suites");
  const query = useQuery({
    queryKey: ["suite", "list"],
    queryFn: async () => body(await api.GET("/api/v1/suites")).items,
  });
  return (
    <>
      <div className="head">
        <h1>Suites</h1>
      </div>
      {query.isPending && <Loading />}
      {query.isError && <Refused error={query.error} onRepeat={() => void query.refetch()} />}
      {query.data?.length === 0 && (
        <Empty
          title="No suite was run yet"
          command={`drivora suite run smoke --agent idm --server ${serviceAddress()}`}
        >
          <p>A suite is a folder of scenarios with a gate, which CI runs.</p>
        </Empty>
      )}
      {query.data && query.data.length > 0 && (
        <div className="plain-table">
          <table>
            <thead>
              <tr>
                <th scope="col">Suite</th>
                <th scope="col">Last decision</th>
                <th scope="col">Pass rate</th>
                <th scope="col">ADS</th>
                <th scope="col" className="number">
                  Runs
                </th>
                <th scope="col">Last run</th>
              </tr>
            </thead>
            <tbody>
              {query.data.map(({ suite, runs, last }) => (
                <tr key={suite}>
                  <th scope="row">
                    <Link to="/suites" search={{ suite }}>
                      {suite}
                    </Link>
                  </th>
                  <td>
                    <Mark {...lookOfGate(last)} />
                  </td>
                  <td>{shareWords(last.pass_rate)}</td>
                  <td>{driverOf(last)}</td>
                  <td className="number">{count(runs)}</td>
                  <td>{moment(last.created_at)}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </div>
      )}
    </>
  );
}
