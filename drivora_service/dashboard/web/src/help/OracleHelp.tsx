import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { api, body } from "../api/client";
import { plain } from "../screens/failures/words";
import { Help } from "./Help";

/** Reads the oracles; they do not change while the service runs. */
function useOracles() {
  return useQuery({
    queryKey: ["oracles"],
    queryFn: async () => body(await api.GET("/api/v1/oracles")),
  });
}

/** The name of an oracle, with its definition and thresholds at a click. */
export function OracleHelp({ name }: { readonly name: string }) {
  const { data } = useOracles();
  const oracle = data?.items.find((one) => one.name === name);
  if (!oracle) return <>{plain(name)}</>;
  const thresholds = Object.entries(oracle.thresholds);
  return (
    <Help name={plain(name)}>
      <h3>{plain(name)}</h3>
      <p>{oracle.description}</p>
      {thresholds.length > 0 && (
        <dl className="facts-list">
          {thresholds.map(([threshold, value]) => (
            <div key={threshold} style={{ display: "contents" }}>
              <dt>{plain(threshold)}</dt>
              <dd>{typeof value === "object" ? JSON.stringify(value) : String(value)}</dd>
            </div>
          ))}
        </dl>
      )}
      {thresholds.length > 0 && <p className="quiet">Thresholds in SI units.</p>}
      <p>
        <Link to="/failures" search={{ oracle: name }}>
          Its failures
        </Link>
        {" · "}
        <Link to="/runs" search={{ oracle: name }}>
          Runs that violate it
        </Link>
      </p>
    </Help>
  );
}
