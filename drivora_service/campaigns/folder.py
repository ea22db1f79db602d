"""The folder of a campaign, and its lock."""

from __future__ import annotations

from pathlib import Path

from drivora_service.campaigns.checkpoints import FolderCheckpoints
from drivora_service.errors import StoreError
from drivora_service.store.campaign_records import CampaignRecord, CampaignRequest, CampaignState
from drivora_service.store.database import Database
from drivora_service.store.file_lock import FileLock, is_locked
from drivora_service.store.traces import CampaignTraces


class CampaignFolder:
    """The folder of a campaign's files.

    Attributes:
        path: The folder.
        traces: Folder of the traces of its failures.
    """

    def __init__(self, root: Path, campaign_id: str) -> None:
        """Prepares the folder of a campaign.

        Args:
            root: Folder of all campaigns.
            campaign_id: Id of the campaign.
        """
        self.path = root / campaign_id
        self.traces = CampaignTraces(root).folder(campaign_id)
        self._id = campaign_id

    def checkpoints(self, told: int) -> FolderCheckpoints:
        """Returns the checkpoints of its tester.

        Args:
            told: Number of evaluations that are stored.
        """
        return FolderCheckpoints(self.path / "checkpoints", told)

    @property
    def is_running(self) -> bool:
        """Whether a process runs the campaign."""
        return self._lock_path.is_file() and is_locked(self._lock_path)

    def lock(self) -> FileLock:
        """Locks the campaign for this process.

        Raises:
            Conflict: Another process runs it.
            StoreError: Its folder cannot be made or written to.
        """
        try:
            return FileLock(
                self._lock_path,
                refusal=lambda holder: f"process {holder} is running campaign {self._id} already",
            )
        except OSError as error:
            raise StoreError(
                f"the folder of campaign {self._id} cannot be used: {error}; make "
                f"{self.path.parent} a folder that can be written to, and resume the campaign"
            ) from error

    @property
    def _lock_path(self) -> Path:
        return self.path / "lock"


def ask_for(
    database: Database, campaign_id: str, folder: CampaignFolder, request: CampaignRequest
) -> CampaignRecord:
    """Pauses or cancels a campaign, whether or not a process runs it.

    Raises:
        UnknownName: There is no such campaign.
        Conflict: It is over, so that it cannot be paused.
    """
    with database.write() as transaction:
        record = transaction.campaigns.ask_for(campaign_id, request)
        if record.state is CampaignState.RUNNING and not folder.is_running:
            # Its process was killed and cannot follow a request.
            ended = {
                CampaignRequest.PAUSE: CampaignState.PAUSED,
                CampaignRequest.CANCEL: CampaignState.CANCELLED,
            }
            record = transaction.campaigns.end(campaign_id, ended[request])
    return record
