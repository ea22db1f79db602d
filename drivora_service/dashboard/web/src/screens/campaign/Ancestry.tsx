import { useQueries } from "@tanstack/react-query";
import { Link, useNavigate, useSearch } from "@tanstack/react-router";
import { firstOf } from "../../address";
import type { Schemas } from "../../api/client";
import { Copy } from "../../components/Copy";
import { Mark } from "../../components/Mark";
import { fixed } from "../../components/numbers";
import { Empty, Loading, Refused } from "../../components/States";
import { MeasureHelp } from "../../help/MeasureHelp";
import { OracleHelp } from "../../help/OracleHelp";
import { serviceAddress } from "../../service";
import { SearchFrom } from "../compose/SearchFrom";
import { ACCOUNTABILITY, kindText, plain } from "../failures/words";
import { replayUpTo } from "../replay/address";
import { replayCommand } from "../replay/againCommand";
import { RunAgain } from "../replay/RunAgain";
import { type Change, changesBetween } from "./changes";
import { type Evaluation, evaluationQuery, useEvaluation } from "./evaluation";
import { Measured } from "./Measured";

/** An evaluation with its ancestors, and what each changed of its parents. */
export function Ancestry({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const search = useSearch({ from: "/campaigns/$id" });
  const navigate = useNavigate();
  const first = campaign.kinds[0]?.first;
  const text = firstOf(search, "number") || (first === undefined ? "" : String(first));
  return (
    <>
      <label className="one">
        Evaluation
        <input
          key={text}
          type="number"
          min={0}
          max={Math.max(campaign.counts.evaluations - 1, 0)}
          defaultValue={text}
          onKeyDown={(event) => {
            if (event.key !== "Enter") return;
            const number = event.currentTarget.value;
            void navigate({ to: ".", search: { ...search, number }, resetScroll: false });
          }}
        />
      </label>
      {text === "" ? (
        <Empty title="No failure so far">
          <p>Type the number of an evaluation to see how it was made.</p>
        </Empty>
      ) : (
        <One campaign={campaign} number={Number(text)} />
      )}
    </>
  );
}

function One({
  campaign,
  number,
}: {
  readonly campaign: Schemas["Campaign"];
  readonly number: number;
}) {
  const query = useEvaluation(campaign.id, number);
  if (query.isPending) return <Loading />;
  if (query.isError) return <Refused error={query.error} onRepeat={() => void query.refetch()} />;
  return (
    <>
      <Verdicts campaign={campaign.id} evaluation={query.data} />
      <Lineage campaign={campaign.id} evaluation={query.data} />
      <Measured evaluation={query.data} />
    </>
  );
}

function Verdicts({
  campaign,
  evaluation,
}: {
  readonly campaign: string;
  readonly evaluation: Evaluation;
}) {
  const { failures, failure_kinds, accountability, number, status, cause, run_id, run_url } =
    evaluation;
  const command = replayCommand(run_id, serviceAddress());
  return (
    <section className="panel">
      <header>
        <h2>Evaluation {number}</h2>
        {accountability && <Mark {...ACCOUNTABILITY[accountability]} />}
        <span className="quiet">
          {status === "judged"
            ? failures.length === 0 && "passed"
            : `${status}${cause && `: ${cause}`}`}
        </span>
      </header>
      <div className="inside">
        {failures.map(({ oracle, ego, message, time }, place) => (
          <p key={`${oracle} ${ego} ${time}`}>
            <OracleHelp name={oracle} />, {ego}
            {time != null && `, at ${time.toFixed(2)} s`}: {message}{" "}
            <span className="quiet">{kindText(failure_kinds[place] ?? "")}</span>
          </p>
        ))}
        <p className="doing">
          {run_url && (
            <Link
              className="button"
              to="/runs/$runId"
              params={{ runId: run_id }}
              search={replayUpTo(failures[0]?.time)}
            >
              {evaluation.observations_url ? "Replay" : "Its run"}
            </Link>
          )}
          {evaluation.scenario_url && !evaluation.observations_url && <RunAgain id={run_id} />}
          {evaluation.scenario_url && (
            <Link
              className="button"
              to="/author"
              search={{ campaign, evaluation: String(evaluation.number) }}
              title="Change the scenario on the map, and run it"
            >
              Edit
            </Link>
          )}
          {evaluation.scenario_url && (
            <SearchFrom search={{ campaign, evaluation: String(number) }} />
          )}
          {evaluation.scenario_url && (
            <Copy text={command} label="Copy the command that runs it again" />
          )}
        </p>
      </div>
    </section>
  );
}

const SHOWN_CHANGES = 4;

function Lineage({
  campaign,
  evaluation,
}: {
  readonly campaign: string;
  readonly evaluation: Evaluation;
}) {
  const search = useSearch({ from: "/campaigns/$id" });
  const numbers = evaluation.lineage.map(({ number }) => number);
  const ancestors = useQueries({
    queries: numbers.map((number) => evaluationQuery(campaign, number)),
    combine: (found) => found.flatMap(({ data }) => (data ? [data] : [])),
  });
  const all = [...ancestors.filter(({ number }) => number !== evaluation.number), evaluation];
  const byNumber = new Map(all.map((one) => [one.number, one]));
  const objectives = Object.keys(evaluation.objectives);
  return (
    <div className="plain-table">
      <table aria-label="Ancestors">
        <thead>
          <tr>
            <th scope="col" className="number">
              Generation
            </th>
            <th scope="col" className="number">
              Evaluation
            </th>
            <th scope="col">Made by</th>
            <th scope="col">Result</th>
            {objectives.map((name) => (
              <th key={name} scope="col" className="number">
                <MeasureHelp name={name} />
              </th>
            ))}
            <th scope="col">Changed against its first parent</th>
          </tr>
        </thead>
        <tbody>
          {all.map((one) => (
            <tr key={one.number} data-current={one.number === evaluation.number}>
              <td className="number">{one.generation}</td>
              <td className="number">
                <Link
                  to="."
                  search={{ ...search, tab: "ancestry", number: String(one.number) }}
                  resetScroll={false}
                >
                  {one.number}
                </Link>
              </td>
              <td>
                {one.origin}
                {one.parents.length > 0 && ` of ${one.parents.join(", ")}`}
              </td>
              <td>
                {one.accountability ? (
                  <Mark {...ACCOUNTABILITY[one.accountability]} />
                ) : (
                  <span className="quiet">{one.status === "judged" ? "passed" : one.status}</span>
                )}
              </td>
              {objectives.map((name) => (
                <td key={name} className="number">
                  {fixed(one.objectives[name], 3) || <span className="quiet">not measurable</span>}
                </td>
              ))}
              <td>
                <Changed evaluation={one} known={byNumber} />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

function Changed({
  evaluation,
  known,
}: {
  readonly evaluation: Evaluation;
  readonly known: ReadonlyMap<number, Evaluation>;
}) {
  if (evaluation.parents.length === 0) return <span className="quiet">has no parent</span>;
  if (evaluation.genes.length === 0)
    return <span className="quiet">genes are not known any more</span>;
  const parent = known.get(evaluation.parents[0] ?? -1);
  if (!parent) return <span className="quiet">its parent is not in the list</span>;
  const changes = changesBetween(parent.genes, evaluation.genes);
  if (changes.length === 0)
    return <span className="quiet">no gene differs from evaluation {parent.number}</span>;
  const rest = changes.length - SHOWN_CHANGES;
  return (
    <span title={changes.map(changeText).join("\n")}>
      {changes.slice(0, SHOWN_CHANGES).map(changeText).join("; ")}
      {rest > 0 && ` and ${rest} more`}
    </span>
  );
}

function changeText({ block, gene, unit, from, to }: Change): string {
  const number = (value: number) => Number(value.toPrecision(4)).toString();
  return `${plain(block)} ${plain(gene)} ${number(from)} → ${number(to)}${unit && ` ${unit}`}`;
}
