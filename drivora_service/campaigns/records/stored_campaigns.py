"""Running a stored campaign."""

from __future__ import annotations

import contextlib
import os
import traceback
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import replace
from typing import TYPE_CHECKING

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_documents import campaign_text
from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.campaigns.records.campaign_folder import CampaignFolder
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.campaigns.search.conducting import Watcher, conduct
from drivora_service.campaigns.search.tester_calls import TesterCall, out_of_memory
from drivora_service.errors import (
    CampaignError,
    Conflict,
    DrivoraError,
    InvalidDocument,
    StoreUnavailable,
    WorkersCannotStart,
)
from drivora_service.plugin_table import describe_missing_packages
from drivora_service.store.campaigns.campaign_records import (
    CampaignRecord,
    CampaignRequest,
    CampaignState,
    NewCampaign,
)
from drivora_service.store.database import Database
from drivora_service.store.engine.ids import new_id
from drivora_service.store.locks.work_locks import LongWork

if TYPE_CHECKING:
    from drivora_service.campaigns.document.campaign_reading import ValidCampaign


_VARIABLES = ("MKL_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


def use_one_thread() -> None:
    """Limits linear algebra to one thread in this process, for good.

    For the small arrays of testers, several threads cost more than they bring. They would take the
    cores of the workers, and add in an order that depends on their number. NumPy and SciPy load a
    library each, SciPy when a tester first needs it.
    """
    # Imported here: commands that search nothing do not need it.
    from threadpoolctl import ThreadpoolController

    # For libraries that are loaded later; those that are loaded have read their variables.
    os.environ.update(dict.fromkeys(_VARIABLES, "1"))
    ThreadpoolController().limit(limits=1)


def new_campaign(valid: ValidCampaign) -> NewCampaign:
    """Returns the values of a campaign for the store."""
    from drivora_service.campaigns.search.search_preparation import search_versions

    campaign = valid.campaign
    return NewCampaign(
        name=campaign.name,
        document=campaign_text(valid.document),
        tester=campaign.tester.name,
        agent=valid.agent,
        configuration=valid.configuration,
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
    is_locked: bool = False,
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
        is_locked: Whether the process that started this one has locked the campaign for it.

    Raises:
        Conflict: Another process runs it, it is over, or it is not queued.
        CampaignError: It cannot continue; the reason is stored.
        InvalidDocument: A name in it is no longer available.
        StoreError: Its folder cannot be made; the campaign is unchanged.
        StoreUnavailable: The database cannot be used now; the campaign is unchanged.
        UnknownName: There is no such campaign.
        WorkersCannotStart: No worker can be started here; the campaign is paused.
    """
    # Imported here: they need the code of all agents, oracles and testers.
    from drivora_service.campaigns.document.campaign_reading import read_campaign
    from drivora_service.campaigns.search.search_preparation import prepare_search

    use_one_thread()
    folder.make()
    with contextlib.ExitStack() as stack:
        if not is_locked:
            stack.callback(database.locks.hold(LongWork.campaign(campaign_id)).release)
        claim = new_id()
        with database.write() as transaction:
            record = transaction.campaigns.begin(campaign_id, only_queued=only_queued, claim=claim)
            # In a study, what a seed does is the same for all methods and repetitions.
            try_seeds = transaction.campaigns.is_first_of_its_scene(campaign_id)
        watcher.on_begun()
        journal = StoreJournal(database, campaign_id, claim=claim)
        asking = replace(watcher, requested=lambda: watcher.requested() or journal.read_request())
        try:
            try:
                valid = read_campaign(record.document, catalogues, is_stored=True)
            except InvalidDocument as error:
                raise _name_missing_packages(error, record) from error
            _refuse_other_network(record, valid)
            _refuse_other_versions(record, valid)
            search = prepare_search(
                valid,
                catalogues,
                run_prefix=campaign_id,
                checkpoints=folder.checkpoints(record.counts.evaluations),
                on_call=watcher.on_call,
            )
            with evaluator(valid.campaign.workers) as evaluating, journal.written_meanwhile():
                state = conduct(
                    search,
                    evaluating,
                    journal,
                    trace_address=folder.trace_address,
                    try_seeds=try_seeds,
                    watcher=asking,
                )
        except KeyboardInterrupt:
            request = asking.requested()
            if request is CampaignRequest.CANCEL:
                journal.end(CampaignState.CANCELLED)
            elif request is not CampaignRequest.NONE or not is_locked:
                journal.end(CampaignState.PAUSED)
            # Else all processes of its service are ended, as by a batch system: the campaign is as
            # after a kill, and is resumed with the service.
            raise
        except MemoryError as error:
            traceback.clear_frames(error.__traceback__)
            message = out_of_memory(TesterCall.MAKE)
            journal.end(CampaignState.FAILED, message)
            raise CampaignError(message) from None
        except WorkersCannotStart as error:
            # A fault of this machine, not of the campaign, which can be resumed after it.
            journal.end(CampaignState.PAUSED, str(error))
            raise
        except (StoreUnavailable, Conflict):
            # Temporary, so that the campaign can be resumed from here; or another process has
            # taken it over.
            raise
        except Exception as error:
            message = str(error) or type(error).__name__
            journal.end(CampaignState.FAILED, message)
            raise
        return journal.end(state)


def _name_missing_packages(error: InvalidDocument, record: CampaignRecord) -> DrivoraError:
    """Returns an error that also says which packages the campaign was made with and lacks now."""
    missing = describe_missing_packages(record.versions, f"campaign {record.id}")
    places = ", ".join(dict.fromkeys(problem.pointer for problem in error.problems))
    return (
        CampaignError(f"{missing}. Its results are kept. Not found: {places}") if missing else error
    )


def _refuse_other_network(record: CampaignRecord, valid: ValidCampaign) -> None:
    if record.network_sha256 != valid.network_sha256:
        raise CampaignError(
            f"the road network {record.town!r} has changed since campaign {record.id} was made; "
            "restore the old network, or start a new campaign"
        )


def _refuse_other_versions(record: CampaignRecord, valid: ValidCampaign) -> None:
    """Refuses to resume a campaign under changed versions."""
    from drivora_service.campaigns.search.search_preparation import search_versions

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
