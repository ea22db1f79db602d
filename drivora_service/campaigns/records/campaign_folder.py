"""The folder of a campaign."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path

from drivora_service.errors import StoreError
from drivora_service.store.traces.trace_folders import CampaignTraces, FailureTraces

_NAME = re.compile(r"(\d{8})\.checkpoint")
_KEPT = 2
"""Number of checkpoints that are kept: the latest may be of evaluations that a kill has lost."""


class FolderCheckpoints:
    """Checkpoints as files that are written as a whole or not at all."""

    def __init__(self, folder: Path, told: int) -> None:
        """Takes a folder, which need not exist.

        Args:
            folder: Folder of the files.
            told: Number of evaluations that are stored, and will be told again.
        """
        self._folder, self._told = folder, told

    def last(self) -> tuple[int, bytes] | None:
        """Returns the latest checkpoint of stored evaluations that can be read."""
        for number, path in reversed(self._files()):
            if number <= self._told:
                with contextlib.suppress(OSError):
                    return number, path.read_bytes()
        return None

    def save(self, told: int, state: bytes) -> None:
        """Keeps the state after ``told`` evaluations, and removes all but the one before.

        A disk that is full or missing costs the checkpoint, not the campaign.
        """
        with contextlib.suppress(OSError):
            self._folder.mkdir(parents=True, exist_ok=True)
            path = self._folder / f"{told:08d}.checkpoint"
            unfinished = path.with_suffix(".unfinished")
            unfinished.write_bytes(state)
            unfinished.replace(path)
            for _, old in self._files()[:-_KEPT]:
                old.unlink(missing_ok=True)

    def _files(self) -> list[tuple[int, Path]]:
        if not self._folder.is_dir():
            return []
        matches = ((_NAME.fullmatch(path.name), path) for path in self._folder.iterdir())
        return sorted((int(match[1]), path) for match, path in matches if match)


class CampaignFolder:
    """The folder of a campaign's files, and the traces of its failures.

    Attributes:
        path: The folder.
    """

    def __init__(self, root: Path, campaign_id: str, traces: FailureTraces | None = None) -> None:
        """Creates the access to the folder, which :meth:`make` creates.

        Args:
            root: Folder of all campaigns.
            campaign_id: Id of the campaign.
            traces: Where traces of failures are; ``None``: in the folder.
        """
        self.path = root / campaign_id
        self._id = campaign_id
        self._traces = CampaignTraces(root) if traces is None else traces

    def make(self) -> None:
        """Creates the folder, so that a campaign does not fail for want of it hours later.

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
