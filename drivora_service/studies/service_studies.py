"""The studies of a service: their campaigns are queued, and the service decides how many run."""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.campaigns.hosts.campaign_host import CampaignHost
from drivora_service.errors import Conflict
from drivora_service.store.campaigns.campaign_records import CampaignRequest, CampaignState
from drivora_service.store.database import Database, Transaction
from drivora_service.store.locks.work_locks import LongWork
from drivora_service.studies.study_storing import NOT_OVER, refuse_if_over


class ServiceStudies:
    """Hands the campaigns of studies to the host of campaigns."""

    def __init__(self, database: Database, campaigns: CampaignHost) -> None:
        """Creates the host, without studies.

        Args:
            database: Database of the service.
            campaigns: Runs the campaigns.
        """
        self._database, self._campaigns = database, campaigns

    def open(self, transaction: Transaction, _study_id: str, campaign_ids: Sequence[str]) -> None:
        """Accepts a new study, in the transaction that stores it."""
        for campaign_id in campaign_ids:
            self._campaigns.open(transaction, campaign_id)

    def resume(self, study_id: str) -> None:
        """Queues the campaigns of a study that do not run.

        Raises:
            UnknownName: There is no such study.
            Conflict: All its campaigns are over, or the process of a command works on it.
        """
        with self._database.write() as transaction:
            refuse_if_over(transaction, study_id)
            if self.has_process(study_id):
                raise Conflict(f"study {study_id} is run by a command already")
            transaction.studies.ask_for(study_id, CampaignRequest.NONE)
            for campaign_id in transaction.studies.campaign_ids(study_id, NOT_OVER):
                self._queue(transaction, campaign_id)
        self.wake()

    def has_process(self, study_id: str) -> bool:
        """Returns whether the process of a command runs a study."""
        return self._database.locks.is_held(LongWork.study(study_id))

    def wake(self) -> None:
        """Starts queued campaigns, or follows requests to them."""
        self._campaigns.wake()

    def _queue(self, transaction: Transaction, campaign_id: str) -> None:
        record = transaction.campaigns.get(campaign_id)
        if record.state is CampaignState.RUNNING:
            is_held = self._database.locks.is_held(LongWork.campaign(campaign_id))
            if record.batch_id or is_held:
                return
            # The command that ran it was killed.
            transaction.campaigns.end(campaign_id, CampaignState.PAUSED)
        transaction.campaigns.queue_again(campaign_id)
        self._campaigns.open(transaction, campaign_id)
