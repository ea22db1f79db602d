import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { api, body } from "../../api/client";
import { count } from "../../components/numbers";
import { Loading, Refused } from "../../components/States";
import { OracleHelp } from "../../help/OracleHelp";
import { plain } from "../failures/words";
import { faultOpen, type MatrixRow, matrixOf, OUTCOMES, searchOf } from "./matrix";

/** Oracles by outcomes of a batch's runs; each number leads to its runs. */
export function OracleMatrix({ batchId }: { readonly batchId: string }) {
  const query = useQuery({
    queryKey: ["batch", batchId, "oracles"],
    queryFn: () =>
      Promise.all(
        OUTCOMES.map(async ({ filter }) =>
          body(
            await api.GET("/api/v1/runs:counts", {
              params: { query: { batch: batchId, ...filter } },
            }),
          ),
        ),
      ),
    placeholderData: keepPreviousData,
  });
  if (query.isPending) return <Loading />;
  if (query.isError) return <Refused error={query.error} onRepeat={() => void query.refetch()} />;
  const rows = matrixOf(query.data);
  const open = faultOpen(rows);
  return (
    <>
      {rows.length > 0 && <Matrix rows={rows} batchId={batchId} />}
      <p className="quiet note">
        {rows.length === 0 ? "No oracle was violated so far." : "All other oracles passed so far."}
      </p>
      {open.length > 0 && (
        <p className="quiet note">
          {open.map(plain).join(", ")}: in some of these runs the fault is undetermined, or the
          oracle does not attribute it. Gates and comparisons count violations of oracles that do
          not attribute fault, but for observations.
        </p>
      )}
    </>
  );
}

function Matrix({
  rows,
  batchId,
}: {
  readonly rows: readonly MatrixRow[];
  readonly batchId: string;
}) {
  return (
    <table className="matrix">
      <thead>
        <tr>
          <th scope="col">Oracle</th>
          {OUTCOMES.map(({ id, title }) => (
            <th key={id} scope="col" className="number">
              {title}
            </th>
          ))}
        </tr>
      </thead>
      <tbody>
        {rows.map(({ oracle, cells }) => (
          <tr key={oracle}>
            <th scope="row">
              <OracleHelp name={oracle} />
            </th>
            {cells.map(({ column, number }) => (
              <td key={column.id} className="number" data-bad={column.bad && number > 0}>
                {number > 0 ? (
                  <Link to="/runs" search={searchOf(batchId, oracle, column)}>
                    {count(number)}
                  </Link>
                ) : (
                  <span className="quiet">0</span>
                )}
              </td>
            ))}
          </tr>
        ))}
      </tbody>
    </table>
  );
}
