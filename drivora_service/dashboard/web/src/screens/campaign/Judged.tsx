import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { api, body, type Schemas } from "../../api/client";
import { count } from "../../components/numbers";

/** Which oracles the campaign counts: its runs are judged by all, and the second runs are among them. */
export function Judged({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const { id, definition } = campaign;
  const { data } = useQuery({
    queryKey: ["run", "list", "counts", { campaign: id }],
    queryFn: async () =>
      body(await api.GET("/api/v1/runs:counts", { params: { query: { campaign: id } } })),
  });
  return (
    <p className="answer quiet">
      {`It counts ${definition.words}. `}
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
