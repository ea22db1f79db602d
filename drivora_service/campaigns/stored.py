"""Running a stored campaign."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import replace
from typing import TYPE_CHECKING

from drivora_service.campaigns.arithmetic import use_one_thread
from drivora_service.campaigns.catalogues import Catalogues
from drivora_service.campaigns.conducting import Watcher, conduct
from drivora_service.campaigns.documents import campaign_text
from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.campaigns.folder import CampaignFolder
from drivora_service.campaigns.store_journal import StoreJournal
from drivora_service.errors import CampaignError, StoreUnavailable, WorkersCannotStart
from drivora_service.store.campaign_records import (
    CampaignRecord,
    CampaignState,
    NewCampaign,
)
from drivora_service.store.database import Database

if TYPE_CHECKING:
    from drivora_service.campaigns.reading import ValidCampaign


def new_campaign(valid: ValidCampaign) -> NewCampaign:
    """Returns the values of a campaign for the store."""
    from drivora_service.campaigns.preparing import search_versions

    campaign = valid.campaign
    return NewCampaign(
        name=campaign.name,
        document=campaign_text(valid.document),
        tester=campaign.tester.name,
        agent=valid.agent,
        town=valid.town,
        network_sha256=valid.network_sha256,
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
    only_queued: bool = False,
) -> CampaignRecord:
    """Starts or resumes a campaign; returns when it is finished or a stop is requested.

    Args:
        database: Holds the campaign.
        campaign_id: Id of the campaign.
        folder: Folder of the campaign.
        catalogues: Catalogues for its names.
        evaluator: Returns the evaluator, for the campaign's number of workers.
        watcher: Callbacks; requests in the database are followed besides.
        only_queued: Whether to run it only if it is queued; see ``CampaignRepository.begin``.

    Raises:
        Conflict: Another process runs it, it is over, or it is not queued.
        CampaignError: It cannot continue; the reason is stored.
        InvalidDocument: A name in it is no longer available.
        StoreUnavailable: The database cannot be used now; the campaign is unchanged.
        UnknownName: There is no such campaign.
        WorkersCannotStart: No worker can be started here; the campaign is paused.
    """
    # Imported here: they need the code of all agents, oracles and testers.
    from drivora_service.campaigns.preparing import prepare_search
    from drivora_service.campaigns.reading import read_campaign

    use_one_thread()
    lock = folder.lock()
    try:
        with database.write() as transaction:
            record = transaction.campaigns.begin(campaign_id, only_queued=only_queued)
        watcher.on_begun()
        journal = StoreJournal(database, campaign_id)
        asking = replace(watcher, requested=lambda: watcher.requested() or journal.requested())
        try:
            valid = read_campaign(record.document, catalogues)
            _refuse_other_network(record, valid)
            _refuse_other_versions(record, valid)
            search = prepare_search(
                valid,
                catalogues,
                run_prefix=campaign_id,
                checkpoints=folder.checkpoints(record.counts.evaluations),
            )
            with evaluator(valid.campaign.workers) as evaluating:
                state = conduct(search, evaluating, journal, traces=folder.traces, watcher=asking)
        except KeyboardInterrupt:
            _end(database, campaign_id, CampaignState.PAUSED, journal)
            raise
        except WorkersCannotStart as error:
            # A fault of this machine, not of the campaign, which can be resumed after it.
            _end(database, campaign_id, CampaignState.PAUSED, journal, str(error))
            raise
        except StoreUnavailable:
            # The fault is temporary; the campaign can be resumed from here.
            raise
        except Exception as error:
            message = str(error) or type(error).__name__
            _end(database, campaign_id, CampaignState.FAILED, journal, message)
            raise
        return _end(database, campaign_id, state, journal)
    finally:
        lock.release()


def hand_over(database: Database, campaign_id: str, folder: CampaignFolder) -> CampaignRecord:
    """Queues a campaign that is not running for the service.

    Raises:
        UnknownName: There is no such campaign.
        Conflict: It is over, or a process runs it.
    """
    with database.write() as transaction:
        record = transaction.campaigns.get(campaign_id)
        deserted = record.state is CampaignState.RUNNING and not record.batch_id
        if deserted and not folder.is_running:
            # The command that ran the campaign was killed.
            transaction.campaigns.end(campaign_id, CampaignState.PAUSED)
        transaction.campaigns.queue_again(campaign_id)
        transaction.campaign_runs.open(campaign_id)
        return transaction.campaigns.get(campaign_id)


def _refuse_other_network(record: CampaignRecord, valid: ValidCampaign) -> None:
    if record.network_sha256 != valid.network_sha256:
        raise CampaignError(
            f"the road network {record.town!r} has changed since campaign {record.id} was made; "
            "restore the old network, or start a new campaign"
        )


def _refuse_other_versions(record: CampaignRecord, valid: ValidCampaign) -> None:
    """Refuses to resume a campaign under changed versions."""
    from drivora_service.campaigns.preparing import search_versions

    now = {**search_versions(), **valid.versions}
    changed = [
        f"{name} was {then} and is {now.get(name, 'not installed')}"
        for name, then in sorted(record.versions.items())
        if now.get(name) != then
    ]
    if changed and record.counts.evaluations:
        raise CampaignError(
            f"campaign {record.id} was made with other versions: {', '.join(changed)}. It cannot "
            "be resumed; install those, or start a new campaign. Its results are kept"
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
