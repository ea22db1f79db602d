import { count } from "../../components/numbers";
import type { Workers } from "./workers";

/** What waits, by priority: the most urgent is taken first. */
export function QueueTable({ queue }: { readonly queue: Workers["queue"] }) {
  return (
    <table className="matrix">
      <thead>
        <tr>
          <th scope="col">Priority</th>
          <th
            scope="col"
            className="number"
            title="Runs with the status running: a worker has them, or gets them next"
          >
            Handed out
          </th>
          <th scope="col" className="number">
            Waiting
          </th>
          <th scope="col" className="number">
            Paused
          </th>
        </tr>
      </thead>
      <tbody>
        {queue.map(({ priority, running, queued, paused }) => (
          <tr key={priority}>
            <th scope="row">{priority}</th>
            <td className="number">{count(running)}</td>
            <td className="number">{count(queued)}</td>
            <td className="number">{count(paused)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
