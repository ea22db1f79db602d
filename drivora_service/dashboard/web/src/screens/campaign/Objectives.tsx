import { useNavigate, useSearch } from "@tanstack/react-router";
import { firstOf } from "../../address";
import type { Schemas } from "../../api/client";
import { Choice } from "../../components/Choice";
import { bestSoFar, paretoFront } from "../../components/charts/curves";
import { Figure } from "../../components/charts/Figure";
import { Scatter, type ScatterPoint } from "../../components/charts/Scatter";
import { Empty, Loading, Refused } from "../../components/States";
import { MeasureHelp } from "../../help/MeasureHelp";
import { ACCOUNTABILITY, plain } from "../failures/words";
import { MOST, useObjectives } from "./useObjectives";

type Row = Schemas["EvaluationSummary"];

const NUMBER = "evaluation";

/** What a search has reached: each evaluation by its objectives, the best so far, the front. */
export function Objectives({ campaign }: { readonly campaign: Schemas["Campaign"] }) {
  const search = useSearch({ from: "/campaigns/$id" });
  const navigate = useNavigate();
  const query = useObjectives(campaign);
  if (query.isPending) return <Loading />;
  if (query.isError) return <Refused error={query.error} onRepeat={() => void query.refetch()} />;
  const { rows, more } = query.data;
  const names = [...new Set(rows.flatMap(({ objectives }) => Object.keys(objectives)))];
  const yName = names.find((name) => name === firstOf(search, "y")) ?? names[0];
  if (!yName)
    return (
      <Empty title="No objectives">
        <p>The method of this campaign measures none, or nothing is judged yet.</p>
      </Empty>
    );
  const others = names.filter((name) => name !== yName);
  const xName = others.find((name) => name === firstOf(search, "x")) ?? NUMBER;
  const open = (number: string) =>
    void navigate({ to: ".", search: { tab: "ancestry", number }, resetScroll: false });
  const measured = rows.flatMap((row) => {
    const x = xName === NUMBER ? row.number : row.objectives[xName];
    const y = row.objectives[yName];
    return typeof x === "number" && typeof y === "number" ? [{ row, x, y }] : [];
  });
  const points = measured.map(({ row, x, y }) => pointOf(row, x, y));
  const line = xName === NUMBER ? bestOf(points) : frontOf(points);
  const missing = rows.length - points.length;
  return (
    <section className="panel">
      <header>
        <h2>Objectives</h2>
        <span className="explained">
          {names.map((name) => (
            <MeasureHelp key={name} name={name} feedback={campaign.tester} />
          ))}
        </span>
        <Choice
          name="y"
          title="Vertical"
          value={yName}
          search={search}
          options={names.map((name) => ({ value: name, text: plain(name) }))}
        />
        <Choice
          name="x"
          title="Horizontal"
          value={xName}
          search={search}
          options={[NUMBER, ...others].map((name) => ({ value: name, text: plain(name) }))}
        />
      </header>
      <div className="inside">
        <Figure
          title={`${plain(yName)} by ${plain(xName)}`}
          note={
            <>
              Smaller is better for the search. Crosses: avoidable failures; triangles: other
              failures; dots: none. A click opens an evaluation.
              {missing > 0 && ` ${missing} evaluations without a measurable value are left out.`}
              {more && ` Only the first ${MOST} are shown.`}
            </>
          }
          file={`${campaign.id}-objectives`}
          numbers={{
            columns: ["evaluation", xName, yName, "failures", "accountability"],
            rows: measured.map(({ row, x, y }) => [
              row.number,
              x,
              y,
              row.violations,
              row.accountability,
            ]),
          }}
        >
          {(width) => (
            <Scatter
              label={`${plain(yName)} by ${plain(xName)} of ${points.length} evaluations`}
              width={width}
              height={360}
              points={points}
              line={line}
              xTitle={plain(xName)}
              yTitle={plain(yName)}
              onOpen={open}
            />
          )}
        </Figure>
      </div>
    </section>
  );
}

function pointOf(row: Row, x: number, y: number): ScatterPoint {
  const { number, violations, accountability } = row;
  const told = accountability ? ACCOUNTABILITY[accountability].text : "failure";
  return {
    id: String(number),
    x,
    y,
    look: violations === 0 ? "other" : accountability === "avoidable" ? "bad" : "lost",
    title: `evaluation ${number}: ${violations === 0 ? "passed" : told}`,
  };
}

function bestOf(points: readonly ScatterPoint[]) {
  const best = bestSoFar(points.map(({ y }) => y));
  return {
    name: "best so far",
    x: points.map(({ x }) => x),
    y: best.flatMap((value) => (value === null ? [] : [value])),
  };
}

function frontOf(points: readonly ScatterPoint[]) {
  const front = paretoFront(points.map(({ x, y }) => [x, y] as const)).flatMap((place) => {
    const point = points[place];
    return point ? [point] : [];
  });
  return { name: "Pareto front", x: front.map(({ x }) => x), y: front.map(({ y }) => y) };
}
