import type { Schemas } from "../api/client";
import { helpAddress } from "./helpAddress";

/** Why a campaign or study says little so far, in quiet lines with what to do. */
export function Warnings({
  warnings,
}: {
  readonly warnings: readonly Schemas["CampaignWarning"][];
}) {
  if (warnings.length === 0) return null;
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
    </ul>
  );
}
