import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { api, body, type Schemas } from "../../api/client";
import { count } from "../../components/numbers";
import { plain } from "../failures/words";

/** Which oracles the campaign counts: its runs are judged by all, and the second runs are among them. */
export function Judged({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const { id, document } = campaign;
  const oracles = Array.isArray(document.oracles) ? document.oracles.map(String) : [];
  const { data } = useQuery({
    queryKey: ["run", "list", "counts", { campaign: id }],
    queryFn: async () =>
      body(await api.GET("/api/v1/runs:counts", { params: { query: { campaign: id } } })),
  });
  return (
    <p className="answer quiet">
      {oracles.length > 0
        ? `It counts violations of ${oracles.map(plain).join(", ")}. `
        : "It counts violations of all oracles. "}
      <Link to="/runs" search={{ campaign: id }}>
        Its runs
      </Link>{" "}
      are judged by all oracles, and include the second runs of failures
      {data && data.violated > 0 && (
        <>
          :{" "}
          <Link to="/runs" search={{ campaign: id, violated: "true" }}>
            {count(data.violated)} of {count(data.total)}
          </Link>{" "}
          violate at least one
        </>
      )}
      .
    </p>
  );
}
