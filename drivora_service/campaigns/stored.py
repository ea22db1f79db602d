"""Running a campaign that is in the database."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import replace

from drivora_service.campaigns.catalogues import Catalogues
from drivora_service.campaigns.conducting import Watcher, conduct
from drivora_service.campaigns.documents import campaign_text
from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.campaigns.folder import CampaignFolder
from drivora_service.campaigns.preparing import prepare_search, search_versions
from drivora_service.campaigns.reading import ValidCampaign, read_campaign
from drivora_service.campaigns.store_journal import StoreJournal
from drivora_service.errors import CampaignError, StoreUnavailable, WorkersCannotStart
from drivora_service.store.campaign_records import (
    CampaignRecord,
    CampaignState,
    NewCampaign,
)
from drivora_service.store.database import Database


def new_campaign(valid: ValidCampaign) -> NewCampaign:
    """Returns what the store wants to know of a campaign."""
    campaign = valid.campaign
    return NewCampaign(
        name=campaign.name,
        document=campaign_text(valid.document),
        tester=campaign.tester.name,
        agent=", ".join(sorted({ego.agent.name for ego in valid.seed.ego_vehicles})),
        town=valid.network.name,
        network_sha256=valid.network.sha256,
        budget=campaign.budget,
        versions={**search_versions(), **valid.versions},
    )


def run_stored(
    database: Database,
    campaign_id: str,
    folder: CampaignFolder,
    *,
    catalogues: Catalogues,
    evaluator: Callable[[int | None], AbstractContextManager[Evaluator]],
    watcher: Watcher = Watcher(),  # noqa: B008 # frozen
    if_wanted: bool = False,
) -> CampaignRecord:
    """Runs a campaign, or goes on with it, until it is finished or somebody wants it to stop.

    Args:
        database: Holds the campaign.
        campaign_id: Which.
        folder: Of this campaign.
        catalogues: Where its names are looked up.
        evaluator: Returns what evaluates, for the number of workers that the campaign wants.
        watcher: Whom to ask and to tell; the database is asked besides.
        if_wanted: Whether to run it only if it waits to be run; see ``CampaignRepository.begin``.

    Raises:
        Conflict: Another process runs it, it is over, or it does not wait to be run.
        CampaignError: It cannot go on; the store knows why.
        InvalidDocument: What it names is not there any more.
        StoreUnavailable: The database cannot be used now; the campaign is as it was.
        UnknownName: There is no such campaign.
        WorkersCannotStart: Nothing can be run on this machine; the campaign is paused.
    """
    lock = folder.lock()
    try:
        with database.write() as transaction:
            record = transaction.campaigns.begin(campaign_id, if_wanted=if_wanted)
        watcher.on_begun()
        journal = StoreJournal(database, campaign_id)
        asking = replace(watcher, requested=lambda: watcher.requested() or journal.requested())
        try:
            valid = read_campaign(record.document, catalogues)
            _refuse_other_network(record, valid)
            _refuse_other_versions(record, valid)
            search = prepare_search(valid, catalogues, run_prefix=campaign_id)
            with evaluator(valid.campaign.workers) as evaluating:
                state = conduct(search, evaluating, journal, traces=folder.traces, watcher=asking)
        except KeyboardInterrupt:
            _end(database, campaign_id, CampaignState.PAUSED, journal)
            raise
        except WorkersCannotStart as error:
            # A fault of this machine, not of the campaign, which goes on from here once it is gone.
            _end(database, campaign_id, CampaignState.PAUSED, journal, str(error))
            raise
        except StoreUnavailable:
            # It passes; whatever runs the campaign again goes on from here.
            raise
        except Exception as error:
            message = str(error) or type(error).__name__
            _end(database, campaign_id, CampaignState.FAILED, journal, message)
            raise
        return _end(database, campaign_id, state, journal)
    finally:
        lock.release()


def hand_over(database: Database, campaign_id: str, folder: CampaignFolder) -> CampaignRecord:
    """Has the service go on with a campaign that rests, whoever ran it before.

    Raises:
        UnknownName: There is no such campaign.
        Conflict: It is over, or a process works on it.
    """
    with database.write() as transaction:
        record = transaction.campaigns.get(campaign_id)
        deserted = record.state is CampaignState.RUNNING and not record.batch_id
        if deserted and not folder.is_running:
            # The command that ran it was killed.
            transaction.campaigns.end(campaign_id, CampaignState.PAUSED)
        transaction.campaigns.queue_again(campaign_id)
        transaction.campaign_runs.open(campaign_id)
        return transaction.campaigns.get(campaign_id)


def _refuse_other_network(record: CampaignRecord, valid: ValidCampaign) -> None:
    if record.network_sha256 != valid.network.sha256:
        raise CampaignError(
            f"the road network {record.town!r} has changed since campaign {record.id} was made; "
            "bring the old one back, or begin a new campaign"
        )


def _refuse_other_versions(record: CampaignRecord, valid: ValidCampaign) -> None:
    """Refuses to go on with a campaign that would have gone another way from its begin."""
    now = {**search_versions(), **valid.versions}
    changed = [
        f"{name} was {then} and is {now.get(name, 'not there')}"
        for name, then in sorted(record.versions.items())
        if now.get(name) != then
    ]
    if changed and record.counts.evaluations:
        raise CampaignError(
            f"campaign {record.id} was made with other versions: {', '.join(changed)}. It would "
            "not go on as it began; install those, or begin a new campaign. What it found stays"
        )


def _end(
    database: Database,
    campaign_id: str,
    state: CampaignState,
    journal: StoreJournal,
    message: str = "",
) -> CampaignRecord:
    with database.write() as transaction:
        return transaction.campaigns.end(
            campaign_id, state, message=message, active_s=journal.active_s()
        )
