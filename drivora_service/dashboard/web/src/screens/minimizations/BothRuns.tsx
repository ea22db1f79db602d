import { Link } from "@tanstack/react-router";
import { Picture } from "../../components/Picture";
import { addressOf } from "../../service";
import { isActive, type Minimization, type Size, sizeWords } from "./minimization";

/** The run of the scenario as it was beside that of the smallest one. */
export function BothRuns({ minimization }: { readonly minimization: Minimization }) {
  const { before, after } = minimization;
  return (
    <div className="two">
      <Side
        title="Before"
        size={before}
        runId={minimization.reproduction_run_id}
        none={before ? "nothing was recorded" : "drawn once the failure has come again"}
      />
      <Side
        title="After"
        size={after}
        runId={minimization.minimal_run_id}
        none={
          isActive(minimization)
            ? "drawn once the smallest scenario has been found and run again"
            : "the smallest scenario so far was not recorded"
        }
      />
    </div>
  );
}

function Side({
  title,
  size,
  runId,
  none,
}: {
  readonly title: string;
  readonly size: Size | null;
  readonly runId: string;
  readonly none: string;
}) {
  return (
    <section className="panel side" aria-label={title}>
      <header>
        <h2>{title}</h2>
        <span className="quiet">{size && sizeWords(size)}</span>
        {runId && (
          <Link className="end" to="/runs/$runId" params={{ runId }} search={{}}>
            Replay
          </Link>
        )}
      </header>
      <Picture
        src={runId && addressOf(`/api/v1/runs/${runId}/picture`)}
        alt={`Moments of the run ${title.toLowerCase()} the minimisation`}
        none={none}
      />
    </section>
  );
}
