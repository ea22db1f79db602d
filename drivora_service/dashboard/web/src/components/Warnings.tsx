import type { Schemas } from "../api/client";
import { helpAddress } from "./helpAddress";

/** Why a campaign or study says little so far, in quiet lines with what to do. */
export function Warnings({
  warnings,
  missing,
}: {
  readonly warnings: readonly Schemas["CampaignWarning"][];
  readonly missing: readonly Schemas["MissingResult"][];
}) {
  if (warnings.length + missing.length === 0) return null;
  return (
    <ul className="warnings quiet" aria-label="Warnings">
      {warnings.map(({ message, advice, page }) => (
        <li key={message}>
          {message} {advice}{" "}
          <a href={helpAddress(page)} target="_blank" rel="noreferrer" title={page}>
            What to do
          </a>
        </li>
      ))}
      {missing.map(({ cause, message, runs }) => (
        <li key={`${cause} ${message}`}>
          {runs} {runs === 1 ? "run" : "runs"} without a result: {message}
        </li>
      ))}
    </ul>
  );
}
