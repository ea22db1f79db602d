import { Link } from "@tanstack/react-router";
import type { Schemas } from "../../api/client";
import { Ads } from "../../components/Ads";
import { Copy } from "../../components/Copy";
import { Mark } from "../../components/Mark";
import { moment } from "../../components/numbers";
import { Picture } from "../../components/Picture";
import { OracleHelp } from "../../help/OracleHelp";
import { serviceAddress } from "../../service";
import { SearchFrom } from "../compose/SearchFrom";
import { replayUpTo } from "../replay/address";
import { replayCommand } from "../replay/againCommand";
import { MinimisedForm } from "./MinimisedForm";
import { ACCOUNTABILITY } from "./words";

/** Why a failure has no picture. */
export function whyNone({ confirmation }: Schemas["FoundFailure"]): string {
  return confirmation === "open"
    ? "drawn once a second run has confirmed it"
    : "nothing was recorded";
}

/** A failure: its picture, its sentence, and where it comes from. */
export function FailureCard({ failure }: { readonly failure: Schemas["FoundFailure"] }) {
  const { verdict, campaign_id, evaluation, accountability } = failure;
  const command = failure.run_id && replayCommand(failure.run_id, serviceAddress());
  return (
    <section className="panel failure-card" aria-live="polite">
      <Picture
        src={failure.picture_url}
        alt={`Moments of: ${failure.sentence}`}
        none={whyNone(failure)}
      />
      <div className="inside">
        <p>{failure.sentence}</p>
        <dl className="facts-list">
          <dt>Oracle</dt>
          <dd>
            <OracleHelp name={failure.oracle} />
          </dd>
          <dt>Accountability</dt>
          <dd>
            {accountability ? (
              <Mark {...ACCOUNTABILITY[accountability]} />
            ) : (
              <span className="quiet">not recorded</span>
            )}
          </dd>
          <dt>Moment</dt>
          <dd>
            {verdict.time == null ? (
              <span className="quiet">the oracle names none</span>
            ) : (
              `${verdict.time.toFixed(2)} s`
            )}
            {failure.avoidable_until !== null &&
              `, avoidable until ${failure.avoidable_until.toFixed(2)} s`}
          </dd>
          <dt>Ego</dt>
          <dd>
            {verdict.ego}, <Ads of={failure} />
            {verdict.counterpart && `, with ${verdict.counterpart}`}
          </dd>
          <dt>Town</dt>
          <dd>{failure.town}</dd>
          {campaign_id && (
            <>
              <dt>Campaign</dt>
              <dd>
                <Link
                  to="/campaigns/$id"
                  params={{ id: campaign_id }}
                  search={{ tab: "ancestry", number: String(evaluation) }}
                >
                  evaluation {evaluation}
                </Link>
                , {failure.confirmation ?? "open"}
              </dd>
            </>
          )}
          <dt>Found</dt>
          <dd>{moment(failure.found_at)}</dd>
        </dl>
        <p className="doing">
          {failure.run_id && (
            <Link
              className="button"
              to="/runs/$runId"
              params={{ runId: failure.run_id }}
              search={replayUpTo(verdict.time)}
            >
              Replay
            </Link>
          )}
          {failure.run_id && <SearchFrom search={{ run: failure.run_id }} />}
          {command && <Copy text={command} label="Copy the command that runs it again" />}
        </p>
        {failure.run_id && <MinimisedForm failure={failure} />}
      </div>
    </section>
  );
}
