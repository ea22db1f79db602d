"""Requests to a campaign: to stop, and to go on in the service."""

from __future__ import annotations

from drivora_service.store.campaigns.campaign_records import (
    CampaignRecord,
    CampaignRequest,
    CampaignState,
)
from drivora_service.store.database import Database
from drivora_service.store.locks.work_locks import LongWork


def ask_for(database: Database, campaign_id: str, request: CampaignRequest) -> CampaignRecord:
    """Pauses or cancels a campaign, whether or not a process runs it.

    Raises:
        UnknownName: There is no such campaign.
        Conflict: It is over, so that it cannot be paused.
    """
    with database.write() as transaction:
        record = transaction.campaigns.ask_for(campaign_id, request)
        is_running = record.state is CampaignState.RUNNING
        if is_running and not database.locks.is_held(LongWork.campaign(campaign_id)):
            # Its process was killed and cannot follow a request.
            ended = {
                CampaignRequest.PAUSE: CampaignState.PAUSED,
                CampaignRequest.CANCEL: CampaignState.CANCELLED,
            }
            record = transaction.campaigns.end(campaign_id, ended[request])
    return record


def hand_over(database: Database, campaign_id: str) -> CampaignRecord:
    """Queues a campaign that is not running for the service.

    Raises:
        UnknownName: There is no such campaign.
        Conflict: It is over, or a process runs it.
    """
    with database.write() as transaction:
        record = transaction.campaigns.get(campaign_id)
        deserted = record.state is CampaignState.RUNNING and not record.batch_id
        if deserted and not database.locks.is_held(LongWork.campaign(campaign_id)):
            # The command that ran the campaign was killed.
            transaction.campaigns.end(campaign_id, CampaignState.PAUSED)
        transaction.campaigns.queue_again(campaign_id)
        transaction.campaign_runs.open(campaign_id)
        return transaction.campaigns.get(campaign_id)
