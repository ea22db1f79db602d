import { Link } from "@tanstack/react-router";
import { Copy } from "../../components/Copy";
import { Mark } from "../../components/Mark";
import { count } from "../../components/numbers";
import { Prose } from "../../components/Prose";
import { type Agent, perceptionOf, valuesInWords } from "./agent";

/** An ADS: what it is, what it sees, its parameters, and whether it can be used here. */
export function AgentCard({
  agent,
  runs,
  selected,
  onSelect,
}: {
  readonly agent: Agent;
  readonly runs: number;
  readonly selected: boolean;
  readonly onSelect: () => void;
}) {
  return (
    <article className="panel agent" id={agent.name} aria-labelledby={`name-${agent.name}`}>
      <header>
        <h2 id={`name-${agent.name}`}>{agent.name}</h2>
        <span className="quiet">{agent.kind}</span>
        <label className="check end">
          <input type="checkbox" checked={selected} onChange={onSelect} />
          Compare
        </label>
      </header>
      <div className="inside stack">
        <p>
          <Prose text={agent.description} />
        </p>
        {!agent.installed && <NotUsable reason={agent.reason} />}
        <dl className="agent-facts">
          <dt>Perception</dt>
          <dd>{agent.privileged ? <strong>{perceptionOf(agent)}</strong> : perceptionOf(agent)}</dd>
          <dt>Source</dt>
          <dd>{agent.source}</dd>
          <dt>Licence</dt>
          <dd>{agent.licence}</dd>
          <dt>Version</dt>
          <dd>{agent.version || <span className="quiet">not stated</span>}</dd>
          <dt>Runs</dt>
          <dd>
            {runs > 0 ? (
              <Link to="/runs" search={{ agent: agent.name }}>
                {count(runs)}
              </Link>
            ) : (
              <span className="quiet">none yet</span>
            )}
          </dd>
        </dl>
        <Parameters agent={agent} />
      </div>
    </article>
  );
}

function NotUsable({ reason }: { readonly reason: string }) {
  const command = /`([^`]+)`/.exec(reason)?.[1];
  return (
    <p className="copies">
      <Mark sign="⊘" tone="lost" text="not usable here: " />
      {command ? <Copy text={command} /> : reason}
    </p>
  );
}

function Parameters({ agent }: { readonly agent: Agent }) {
  if (agent.parameters === null)
    return <p className="quiet">It does not declare its parameters; documents may set any.</p>;
  if (agent.parameters.length === 0) return <p className="quiet">No parameters.</p>;
  return (
    <table className="matrix">
      <thead>
        <tr>
          <th scope="col">Parameter</th>
          <th scope="col" className="number">
            Default
          </th>
          <th scope="col">Allowed</th>
        </tr>
      </thead>
      <tbody>
        {agent.parameters.map((parameter) => (
          <tr key={parameter.name} title={parameter.description}>
            <th scope="row">
              <code>{parameter.name}</code>
            </th>
            <td className="number">{JSON.stringify(parameter.default)}</td>
            <td>
              {valuesInWords(parameter.values)}
              <div className="quiet">
                <Prose text={parameter.description} />
              </div>
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
