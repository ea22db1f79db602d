import { Link } from "@tanstack/react-router";
import { Mark } from "../../components/Mark";
import { count, duration, moment } from "../../components/numbers";
import { useNow } from "./useNow";
import { lookOfSlot, megabytes, phaseOf, type Slot, secondsSince } from "./workers";

/** What each slot does and since when. */
export function SlotTable({ slots }: { readonly slots: readonly Slot[] }) {
  const now = useNow();
  const foreign = slots.some(({ is_own }) => !is_own);
  return (
    <table className="matrix">
      <thead>
        <tr>
          <th scope="col">Slot</th>
          {foreign && <th scope="col">Of</th>}
          <th scope="col">State</th>
          <th scope="col" className="number">
            For
          </th>
          <th scope="col">Run</th>
          <th scope="col" className="number">
            Step
          </th>
          <th scope="col" className="number">
            Memory (MB)
          </th>
          <th scope="col" className="number">
            Process
          </th>
          <th scope="col" className="number">
            Runs ended
          </th>
          <th scope="col" className="number" title="Worker processes that came after the first one">
            Recycled
          </th>
          <th scope="col">Last death</th>
        </tr>
      </thead>
      <tbody>
        {slots.map((slot) => (
          <tr key={`${slot.process} ${slot.name}`}>
            <th scope="row">{slot.name}</th>
            {foreign && <td>{slot.is_own ? "this service" : `a command on ${slot.host}`}</td>}
            <td>
              <Mark {...lookOfSlot(slot)} /> <span className="quiet">{phaseOf(slot)}</span>
            </td>
            <td className="number">
              <Since seconds={secondsSince(slot, now)} />
            </td>
            <td>
              {slot.run_id && (
                <Link to="/runs/$runId" params={{ runId: slot.run_id }}>
                  <code>{slot.run_id}</code>
                </Link>
              )}
            </td>
            <td className="number">{slot.run_id ? count(slot.step) : ""}</td>
            <td className="number">{megabytes(slot.memory_bytes)}</td>
            <td className="number">{slot.pid}</td>
            <td className="number">{count(slot.runs)}</td>
            <td className="number">{count(slot.recycled)}</td>
            <td>
              {slot.last_death ? (
                <span className="refusal">
                  {slot.last_death.at && `${moment(slot.last_death.at)}: `}
                  {slot.last_death.cause}
                </span>
              ) : (
                <span className="quiet">none</span>
              )}
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function Since({ seconds }: { readonly seconds: number | undefined }) {
  if (seconds === undefined) return <span className="quiet">not recorded</span>;
  return duration(seconds);
}
