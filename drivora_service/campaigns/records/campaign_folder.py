"""The folder of a campaign."""

from __future__ import annotations

from pathlib import Path

from drivora_service.campaigns.search.folder_checkpoints import FolderCheckpoints
from drivora_service.errors import StoreError
from drivora_service.store.traces.trace_folders import CampaignTraces, FailureTraces


class CampaignFolder:
    """The folder of a campaign's files, and the traces of its failures.

    Attributes:
        path: The folder.
    """

    def __init__(self, root: Path, campaign_id: str, traces: FailureTraces | None = None) -> None:
        """Prepares the folder of a campaign.

        Args:
            root: Folder of all campaigns.
            campaign_id: Id of the campaign.
            traces: Where traces of failures are; ``None``: in the folder.
        """
        self.path = root / campaign_id
        self._id = campaign_id
        self._traces = CampaignTraces(root) if traces is None else traces

    def make(self) -> None:
        """Makes the folder, so that a campaign does not fail for want of it hours later.

        Raises:
            StoreError: It cannot be made.
        """
        try:
            self.path.mkdir(mode=0o700, parents=True, exist_ok=True)
        except OSError as error:
            raise StoreError(
                f"the folder of campaign {self._id} cannot be used: {error}; make "
                f"{self.path.parent} a folder that can be written to, and resume the campaign"
            ) from error

    def trace(self, name: str) -> Path:
        """Returns the path of the trace ``name`` of a failure, which may not exist."""
        return self._traces.path(self._id, name)

    def trace_address(self, name: str) -> str:
        """Returns where a worker writes the trace ``name`` of a failure."""
        return self._traces.address(self._id, name)

    def checkpoints(self, told: int) -> FolderCheckpoints:
        """Returns the checkpoints of its tester.

        Args:
            told: Number of evaluations that are stored.
        """
        return FolderCheckpoints(self.path / "checkpoints", told)
