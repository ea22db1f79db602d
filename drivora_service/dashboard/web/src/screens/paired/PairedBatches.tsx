import { useQuery } from "@tanstack/react-query";
import { Link, useSearch } from "@tanstack/react-router";
import { firstOf, type Search } from "../../address";
import { api, body, type Schemas } from "../../api/client";
import { Choice } from "../../components/Choice";
import { COUNTED_CHOICES, countedOf, definitionSentence } from "../../components/definition";
import { Empty, Loading, Refused } from "../../components/States";
import { csvLines, storeFile } from "../../lists/csv";
import { useTitle } from "../../shell/useTitle";
import { LeftOut } from "./LeftOut";
import { Metrics } from "./Metrics";
import { Oracles } from "./Oracles";
import { PairTable } from "./PairTable";
import { type Comparison, csvRows, failureTest } from "./paired";
import { Sides } from "./Sides";
import { Table } from "./Table";
import "./paired.css";

const ASK_AGAIN_MS = 5_000;

const UNFINISHED = [
  { value: "agent", text: "if the ADS ended them" },
  { value: "all", text: "always" },
  { value: "none", text: "never" },
] as const;

function oneOf<Value extends string>(
  options: readonly { readonly value: Value }[],
  word: string,
): Value | undefined {
  return options.find(({ value }) => value === word)?.value;
}

/** Two batches on the same scenarios: how they stand, then the evidence, pair by pair. */
export function PairedBatches() {
  useTitle("Compare batches");
  const search = useSearch({ from: "/compare/batches" });
  const a = firstOf(search, "a");
  const b = firstOf(search, "b");
  const counts = countedOf(firstOf(search, "counts"));
  const unfinished = oneOf(UNFINISHED, firstOf(search, "unfinished"));
  const query = useQuery({
    queryKey: ["batch", b, "compared", a, counts, unfinished],
    enabled: a !== "" && b !== "",
    queryFn: async () =>
      body(
        await api.GET("/api/v1/batches:compare", {
          params: {
            query: {
              a,
              b,
              ...(counts ? { counts } : {}),
              ...(unfinished ? { unfinished } : {}),
            },
          },
        }),
      ),
    refetchInterval: ({ state }) => (state.data && waits(state.data) ? ASK_AGAIN_MS : false),
  });
  if (a === "" || b === "")
    return (
      <Empty title="Nothing to compare yet" command="drivora compare BATCH BATCH">
        <p>
          Select two <Link to="/batches">batches</Link> of the same scenarios with <kbd>x</kbd>, and
          press <kbd>c</kbd>.
        </p>
      </Empty>
    );
  if (query.isPending) return <Loading />;
  if (query.isError) return <Refused error={query.error} onRepeat={() => void query.refetch()} />;
  return <Loaded found={query.data} search={search} />;
}

const waits = ({ left_out }: Comparison) => left_out.some(({ reason }) => reason === "not_ended");

function Loaded({ found, search }: { readonly found: Comparison; readonly search: Search }) {
  return (
    <>
      <div className="head">
        <h1>Two batches compared</h1>
        <div className="actions">
          <Link
            to="/compare/batches"
            search={{ ...search, a: firstOf(search, "b"), b: firstOf(search, "a") }}
            className="button"
          >
            Swap A and B
          </Link>
          <button
            type="button"
            title="Every pair as a file for a spreadsheet"
            onClick={() =>
              storeFile("pairs.csv", "text/csv;charset=utf-8", [csvLines(csvRows(found.pairs))])
            }
          >
            CSV
          </button>
        </div>
      </div>
      <p className="standing" role="status">
        {found.sentence}
      </p>
      <Notes notes={found.notes} />
      <p className="quiet">{definitionSentence(found.definition)}</p>
      <div className="filters">
        <Choice
          name="counts"
          title="Failures are violations"
          value={countedOf(firstOf(search, "counts")) ?? ""}
          options={COUNTED_CHOICES}
          search={search}
        />
        <Choice
          name="unfinished"
          title="Runs without a judgement are failures"
          value={found.unfinished}
          options={UNFINISHED}
          search={search}
        />
      </div>
      <div className="two">
        <Sides found={found} />
        {found.failures && found.scenarios > 0 && (
          <Table failures={found.failures} test={testOf(found)} search={search} />
        )}
      </div>
      {found.scenarios > 0 && <Evidence found={found} search={search} />}
      <LeftOut rows={found.left_out} />
    </>
  );
}

const testOf = ({ pairs, scenarios }: Comparison) => failureTest(pairs.length, scenarios);

function Evidence({ found, search }: { readonly found: Comparison; readonly search: Search }) {
  return (
    <>
      {found.by_oracle.length > 0 && (
        <Oracles
          rows={found.by_oracle}
          search={search}
          scenarios={found.scenarios}
          test={testOf(found)}
        />
      )}
      <PairTable found={found} search={search} />
      <Metrics metrics={found.metrics} />
    </>
  );
}

function Notes({ notes }: { readonly notes: Schemas["BatchComparison"]["notes"] }) {
  return notes.map((note) => (
    <p key={note} className="quiet">
      {note}
    </p>
  ));
}
