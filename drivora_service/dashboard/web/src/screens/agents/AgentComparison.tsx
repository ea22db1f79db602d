import { Prose } from "../../components/Prose";
import { type Agent, compared } from "./agent";

/** Agents side by side: what differs first, what is the same below it. */
export function AgentComparison({
  agents,
  onClose,
}: {
  readonly agents: readonly Agent[];
  readonly onClose: () => void;
}) {
  const rows = compared(agents);
  return (
    <section className="panel" aria-label="Comparison">
      <header>
        <h2>Compared: what differs first</h2>
        <button type="button" className="end" onClick={onClose}>
          End the comparison
        </button>
      </header>
      <table className="matrix sides">
        <thead>
          <tr>
            <th scope="col">Property</th>
            {agents.map(({ name }) => (
              <th key={name} scope="col">
                {name}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {rows.map(({ name, values, differs }) => (
            <tr key={name} data-same={!differs}>
              <th scope="row">{name}</th>
              {values.map((value, place) => (
                // One value an agent, in the agents' order.
                <td key={agents[place]?.name}>
                  <Prose text={value} />
                </td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}
