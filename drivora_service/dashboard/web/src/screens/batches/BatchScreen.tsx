import { useQuery } from "@tanstack/react-query";
import { Link, useParams } from "@tanstack/react-router";
import { api, body } from "../../api/client";
import { Copy } from "../../components/Copy";
import { configurationFilter } from "../../components/configuration";
import { definitionSentence } from "../../components/definition";
import { Mark } from "../../components/Mark";
import { count, moment } from "../../components/numbers";
import { Shares } from "../../components/Shares";
import { Loading, Refused } from "../../components/States";
import { ResultTables } from "../../lists/ResultTables";
import { useTitle } from "../../shell/useTitle";
import { STATUS_WORDS } from "../runs/status";
import { BatchActions } from "./BatchActions";
import { BatchChoice } from "./BatchChoice";
import { BatchParts } from "./BatchParts";
import { type Batch, lookOfBatch, sharesOf, standingOf } from "./batch";
import { OracleMatrix } from "./OracleMatrix";

/** A batch: how far it is, and what its oracles found. */
export function BatchScreen() {
  const { batchId } = useParams({ from: "/batches/$batchId" });
  const query = useQuery({
    queryKey: ["batch", batchId],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/batches/{batch_id}", { params: { path: { batch_id: batchId } } }),
      ),
  });
  useTitle(query.data?.name || "Batch");
  if (query.isPending) return <Loading />;
  if (query.isError) return <Refused error={query.error} onRepeat={() => void query.refetch()} />;
  const batch = query.data;
  return (
    <>
      <div className="head">
        <h1>{batch.name || "Batch"}</h1>
        <Mark {...lookOfBatch(batch)} />
        <Answer batch={batch} />
        <div className="actions">
          <BatchActions batch={batch} />
          <BatchChoice batch={batch} />
          <ResultTables name={batch.name || "batch"} conditions={{ batch: batch.id }} />
          <Link to="/runs" search={{ batch: batch.id }} className="button">
            All its runs
          </Link>
        </div>
      </div>
      <Shares shares={sharesOf(batch)} of={batch.size} />
      <p className="quiet">
        Priority {batch.priority} · queued at {moment(batch.created_at)} · <Copy text={batch.id} />
      </p>
      <div className="columns-2-1">
        <section className="panel">
          <header>
            <h2>Runs by oracle and outcome</h2>
          </header>
          <OracleMatrix batchId={batch.id} />
        </section>
        <div className="stack">
          <BatchParts
            title="Status"
            numbers={batch.counts ?? {}}
            words={(value) => (STATUS_WORDS as Record<string, string>)[value] ?? value}
            searchFor={(status) => ({ batch: batch.id, status })}
          />
          <Facets batch={batch} />
        </div>
      </div>
    </>
  );
}

function Answer({ batch }: { readonly batch: Batch }) {
  const { ended, violated, notJudged } = standingOf(batch);
  return (
    <p className="answer" role="status">
      {count(ended)} of {count(batch.size)} runs ended
      {violated > 0 && (
        <>
          {" · "}
          <Link to="/runs" search={{ batch: batch.id, violated: "true" }}>
            {count(violated)} with violations
          </Link>
        </>
      )}
      {batch.failing_runs > 0 && (
        <>
          {" · "}
          <Link to="/failures" search={{ batch: batch.id }}>
            {count(batch.failing_runs)} failing
          </Link>
        </>
      )}
      {notJudged > 0 && ` · ${count(notJudged)} not judged`}
      {batch.failing_runs > 0 && batch.definition && (
        <span className="quiet">. {definitionSentence(batch.definition)}</span>
      )}
    </p>
  );
}

/** ADSs and towns of a batch with more than one of them. */
function Facets({ batch }: { readonly batch: Batch }) {
  const counts = useQuery({
    queryKey: ["batch", batch.id, "counts"],
    queryFn: async () =>
      body(await api.GET("/api/v1/runs:counts", { params: { query: { batch: batch.id } } })),
  });
  if (!counts.data) return null;
  const configurations = configurationFilter(counts.data.configurations);
  const ids = Object.keys(configurations.counts);
  return (
    <>
      {ids.length > 1 && (
        <BatchParts
          title="ADS"
          numbers={configurations.counts}
          searchFor={(configuration) => ({ batch: batch.id, configuration })}
          words={(id) => configurations.words[id] ?? id}
        />
      )}
      {(["agent", "town"] as const)
        // ADSs of which only the name was recorded have no id.
        .filter(
          (name) =>
            Object.keys(counts.data[name]).length >
            (name === "agent" ? Math.max(ids.length, 1) : 1),
        )
        .map((name) => (
          <BatchParts
            key={name}
            title={name === "agent" ? "ADS" : "Town"}
            numbers={counts.data[name]}
            searchFor={(value) => ({ batch: batch.id, [name]: value })}
          />
        ))}
    </>
  );
}
