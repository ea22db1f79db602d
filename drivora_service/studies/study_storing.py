"""Storing a study with all its campaigns, and requests to all of them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from drivora_service.errors import Conflict
from drivora_service.store.campaigns.campaign_records import CampaignRequest, CampaignState
from drivora_service.store.campaigns.study_records import StudyState, state_of
from drivora_service.store.database import Database, Transaction
from drivora_service.store.locks.work_locks import LongWork

if TYPE_CHECKING:
    from drivora_service.studies.study_host import StudyHost
    from drivora_service.studies.study_reading import ValidStudy

NOT_OVER = tuple(state for state in CampaignState if not state.is_over)
"""States of campaigns that may go on."""
_STOPS = {
    CampaignRequest.PAUSE: ((CampaignState.QUEUED, CampaignState.RUNNING), CampaignState.PAUSED),
    CampaignRequest.CANCEL: (NOT_OVER, CampaignState.CANCELLED),
}
"""The states of the campaigns that a request stops, and their state afterwards."""


def store_study(transaction: Transaction, study: ValidStudy, host: StudyHost) -> str:
    """Stores a study and its campaigns for a host; returns its id."""
    from drivora_service.studies.study_documents import study_text

    study_id = transaction.studies.create(
        name=study.document.name, document=study_text(study.document)
    )
    campaign_ids = [
        transaction.campaigns.create(replace(campaign, study_id=study_id)).id
        for campaign in study.campaigns
    ]
    host.open(transaction, study_id, campaign_ids)
    return study_id


def stop_study(database: Database, study_id: str, request: CampaignRequest) -> None:
    """Requests that the campaigns of a study stop; those that do not run stop at once.

    A request that is already fulfilled changes nothing, and none replaces a cancellation.

    Args:
        database: Holds the study.
        study_id: Id of the study.
        request: ``pause``: those that run or wait; ``cancel``: all that are not over.

    Raises:
        UnknownName: There is no such study.
        Conflict: All its campaigns are over.
    """
    states, ended = _STOPS[request]
    with database.write() as transaction:
        study = transaction.studies.get(study_id)
        is_cancelled = state_of(study, has_process=False) is StudyState.CANCELLED
        if request is CampaignRequest.CANCEL and is_cancelled:
            return
        refuse_if_over(transaction, study_id)
        if study.request is not CampaignRequest.CANCEL:
            transaction.studies.ask_for(study_id, request)
        for campaign_id in transaction.studies.campaign_ids(study_id, states):
            record = transaction.campaigns.ask_for(campaign_id, request)
            is_deserted = (
                record.state is CampaignState.RUNNING
                and not record.batch_id
                and not database.locks.is_held(LongWork.campaign(campaign_id))
            )
            if is_deserted:
                # Its process was killed and cannot follow a request.
                transaction.campaigns.end(campaign_id, ended)


def refuse_if_over(transaction: Transaction, study_id: str) -> None:
    """Refuses a study whose campaigns are all over.

    Raises:
        UnknownName: There is no such study.
        Conflict: They are.
    """
    counts = transaction.studies.get(study_id).campaigns
    if not any(counts.get(state) for state in NOT_OVER):
        raise Conflict(f"all campaigns of study {study_id} are over; start a new study")
