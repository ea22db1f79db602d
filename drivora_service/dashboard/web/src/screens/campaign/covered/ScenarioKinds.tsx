import type { Schemas } from "../../../api/client";
import { count } from "../../../components/numbers";
import { kindTable } from "./kindTable";

type Kind = Schemas["ScenarioKind"];

const TURN_WORDS: Readonly<Record<Kind["turn"], string>> = {
  straight: "straight on",
  left: "left",
  right: "right",
  back: "back",
  unknown: "not known",
};
const OTHERS_WORDS: Readonly<Record<Kind["others"], string>> = {
  vehicles: "vehicles",
  walkers: "walkers",
  obstacles: "obstacles",
  egos: "other egos",
  none: "none",
};

/** The turns of egos against the kinds of other actors: simulations, and those that failed. */
export function ScenarioKinds({
  kinds,
  simulations,
}: {
  readonly kinds: readonly Kind[];
  readonly simulations: number;
}) {
  const { turns, others, at } = kindTable(kinds);
  return (
    <section className="panel">
      <header>
        <h2>Kinds of scenarios</h2>
      </header>
      <div className="plain-table study-matrix">
        <table aria-label="Simulations by turn of an ego and other actors">
          <thead>
            <tr>
              <th rowSpan={2} scope="col">
                Turn of an ego
              </th>
              <th scope="colgroup" colSpan={others.length}>
                Other actors
              </th>
            </tr>
            <tr>
              {others.map((name) => (
                <th key={name} scope="col" className="number">
                  {OTHERS_WORDS[name]}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {turns.map((turn) => (
              <tr key={turn}>
                <th scope="row">{TURN_WORDS[turn]}</th>
                {others.map((name) => (
                  <td key={name}>
                    <Cell kind={at(turn, name)} of={simulations} />
                  </td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <p className="inside quiet">
        Simulations, and those with avoidable failures + with others; bars: shares of all. A
        simulation with several turns or kinds of actors is in each.
        {turns.includes("unknown") &&
          " A turn is not known where a route has no heading at its start or its end."}
      </p>
    </section>
  );
}

function Cell({ kind, of }: { readonly kind: Kind | undefined; readonly of: number }) {
  if (!kind) return <span className="kind quiet">0</span>;
  const { simulations, failing, avoidable } = kind;
  const others = failing - avoidable;
  const width = (number: number) => `${of > 0 ? (number / of) * 100 : 0}%`;
  return (
    <span
      className="kind"
      title={`${count(simulations)} simulations; ${count(avoidable)} with avoidable failures, ${count(others)} with others`}
    >
      {count(simulations)}
      <small>
        <strong className={avoidable ? "bad" : "quiet"}>{count(avoidable)}</strong>{" "}
        <span className="quiet">+ {count(others)}</span>
      </small>
      <span className="bar" aria-hidden="true">
        <span className="counting" style={{ width: width(avoidable) }} />
        <span className="rest" style={{ width: width(others) }} />
        <span className="passed" style={{ width: width(simulations - failing) }} />
      </span>
    </span>
  );
}
