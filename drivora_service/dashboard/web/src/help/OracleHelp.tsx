import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { api, body, type Schemas } from "../api/client";
import { plain } from "../screens/failures/words";
import { Help } from "./Help";

/** Reads the oracles; they do not change while the service runs. */
function useOracles() {
  return useQuery({
    queryKey: ["oracles"],
    queryFn: async () => body(await api.GET("/api/v1/oracles")),
  });
}

/** The name of an oracle; a click shows its definition, its thresholds and where they come from. */
export function OracleHelp({ name }: { readonly name: string }) {
  const { data } = useOracles();
  const oracle = data?.items.find((one) => one.name === name);
  if (!oracle) return <>{plain(name)}</>;
  return (
    <Help name={plain(name)}>
      <h3>{plain(name)}</h3>
      <p>{oracle.definition}</p>
      <Thresholds oracle={oracle} />
      {oracle.source && <p className="quiet">{oracle.source}</p>}
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

function Thresholds({ oracle }: { readonly oracle: Schemas["Oracle"] }) {
  const told = new Map(oracle.threshold_descriptions.map((one) => [one.name, one]));
  const values = Object.entries(oracle.thresholds);
  if (values.length === 0) return null;
  return (
    <dl className="facts-list thresholds">
      {values.map(([name, value]) => {
        const about = told.get(name);
        return (
          <div key={name} style={{ display: "contents" }}>
            <dt>
              {plain(name)}
              <br />
              <strong>
                {typeof value === "object" ? JSON.stringify(value) : String(value)} {about?.unit}
              </strong>
            </dt>
            <dd>
              {about?.meaning}
              {about?.source && <span className="quiet"> {about.source}</span>}
            </dd>
          </div>
        );
      })}
    </dl>
  );
}
