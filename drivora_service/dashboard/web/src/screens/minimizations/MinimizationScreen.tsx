import { useQuery } from "@tanstack/react-query";
import { Link, useParams } from "@tanstack/react-router";
import { api, body } from "../../api/client";
import { Copy } from "../../components/Copy";
import { Mark } from "../../components/Mark";
import { count, moment } from "../../components/numbers";
import { Empty, Loading, Refused } from "../../components/States";
import { useTitle } from "../../shell/useTitle";
import { ACCOUNTABILITY } from "../failures/words";
import { BothRuns } from "./BothRuns";
import { CancelMinimization } from "./CancelMinimization";
import {
  answerOf,
  isActive,
  lookOfMinimization,
  type Minimization,
  minimizeCommand,
  nameOf,
  stageWords,
  tookWords,
} from "./minimization";
import { SizeTable } from "./SizeTable";
import { SmallestScenario } from "./SmallestScenario";
import "./minimizations.css";
import { serviceAddress } from "../../service";

/** A minimisation: how far it is, what became smaller, and the smallest scenario. */
export function MinimizationScreen() {
  const { id } = useParams({ from: "/minimizations/$id" });
  const query = useQuery({
    queryKey: ["minimization", id],
    queryFn: async () =>
      body(
        await api.GET("/api/v1/minimizations/{minimization_id}", {
          params: { path: { minimization_id: id } },
        }),
      ),
  });
  useTitle(query.data ? `Minimisation: ${nameOf(query.data)}` : "Minimisation");
  if (query.isPending) return <Loading rows={12} />;
  if (query.isError) return <Refused error={query.error} onRepeat={() => void query.refetch()} />;
  const minimization = query.data;
  const { reproduction_run_id: was, minimal_run_id: now } = minimization;
  return (
    <>
      <div className="head">
        <h1>Minimisation: {nameOf(minimization)}</h1>
        <Mark {...lookOfMinimization(minimization)} />
        <p className="answer" role="status">
          {answerOf(minimization)}
        </p>
        <div className="actions">
          <CancelMinimization minimization={minimization} />
          {was && now && (
            <Link
              className="button"
              to="/runs/$runId"
              params={{ runId: was }}
              search={{ with: now, view: "side" }}
            >
              Compare both replays
            </Link>
          )}
          <Copy text={minimizeCommand(minimization, serviceAddress())} label="Copy the command" />
        </div>
      </div>
      <Facts minimization={minimization} />
      {isActive(minimization) && <Progress minimization={minimization} />}
      <NotDone minimization={minimization} />
      <Result minimization={minimization} />
    </>
  );
}

/** What is followed, and where it comes from. */
function Facts({ minimization }: { readonly minimization: Minimization }) {
  const { id, run_id, batch_id, failure, budget, decided, simulations, created_at } = minimization;
  const took = tookWords(minimization);
  return (
    <p className="minimization-facts">
      <Mark {...ACCOUNTABILITY[failure.accountability]} />
      <span>
        of run{" "}
        <Link to="/runs/$runId" params={{ runId: run_id }} search={{}}>
          {run_id}
        </Link>
      </span>
      <span title="The budget limits the simulations that the search needs. Workers make some ahead of it, which it may not need.">
        <Link to="/batches/$batchId" params={{ batchId: batch_id }}>
          {count(simulations)} simulations
        </Link>
        {!isActive(minimization) && `, ${count(decided)} decided of ${count(budget)}`}
      </span>
      <span>
        queued at {moment(created_at)}
        {took && `, took ${took}`}
      </span>
      <span className="copies">
        <Copy text={id} />
      </span>
    </p>
  );
}

/** What an active minimisation does now, and how much of its budget that took. */
function Progress({
  minimization: { stage, decided, budget },
}: {
  readonly minimization: Minimization;
}) {
  return (
    <div className="panel minimizing">
      <span className="stage">{stageWords(stage)}</span>
      <progress aria-label="Decided of the budget" max={budget} value={decided} />
      <span className="quiet">
        {count(decided)} decided of {count(budget)}; it ends as soon as every single reduction was
        tried
      </span>
    </div>
  );
}

/** What can be done where a minimisation has ended without its result. */
function NotDone({ minimization }: { readonly minimization: Minimization }) {
  const { state, before } = minimization;
  const command = minimizeCommand(minimization, serviceAddress());
  if (state === "failed")
    return (
      <Empty title="The failure could not be followed" command={command}>
        <p>
          A failure is followed only if it comes again when its scenario is run again. The command
          tries it once more.
        </p>
      </Empty>
    );
  if (state === "interrupted")
    return (
      <Empty title="It can go on" command={command}>
        <p>The same command goes on from the simulations that were made.</p>
      </Empty>
    );
  if (state === "cancelled" && !before)
    return (
      <Empty title="There is no smaller scenario" command={command}>
        <p>The command begins it again.</p>
      </Empty>
    );
  return null;
}

/** What became smaller: no numbers before the failure was reproduced. */
function Result({ minimization }: { readonly minimization: Minimization }) {
  const { before, after, removed } = minimization;
  if (!before || !after)
    return isActive(minimization) ? <BothRuns minimization={minimization} /> : null;
  return (
    <>
      <BothRuns minimization={minimization} />
      <div className="two">
        <div className="stack">
          <SizeTable before={before} after={after} />
          <Removed sentences={removed} />
        </div>
        <SmallestScenario minimization={minimization} />
      </div>
    </>
  );
}

/** What the smallest scenario lacks, in the service's sentences. */
function Removed({ sentences }: { readonly sentences: readonly string[] }) {
  return (
    <section className="panel" aria-label="What was removed">
      <header>
        <h2>What was removed</h2>
      </header>
      {sentences.length > 0 ? (
        <ul className="inside sentences">
          {sentences.map((sentence) => (
            <li key={sentence}>{sentence}</li>
          ))}
        </ul>
      ) : (
        <p className="inside quiet">Nothing so far.</p>
      )}
    </section>
  );
}
