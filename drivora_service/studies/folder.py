"""The folder of a study, and its lock."""

from __future__ import annotations

from pathlib import Path

from drivora_service.errors import StoreError
from drivora_service.store.file_lock import FileLock, is_locked


class StudyFolder:
    """The folder with the lock of a study that the process of a command runs."""

    def __init__(self, root: Path, study_id: str) -> None:
        """Prepares the folder of a study.

        Args:
            root: Folder of all studies.
            study_id: Id of the study.
        """
        self._path, self._id = root / study_id, study_id

    @property
    def is_running(self) -> bool:
        """Whether the process of a command runs the study."""
        return self._lock_path.is_file() and is_locked(self._lock_path)

    def lock(self) -> FileLock:
        """Locks the study for this process.

        Raises:
            Conflict: Another process runs it.
            StoreError: Its folder cannot be made or written to.
        """
        try:
            return FileLock(
                self._lock_path,
                refusal=lambda holder: f"process {holder} is running study {self._id} already",
            )
        except OSError as error:
            raise StoreError(
                f"the folder of study {self._id} cannot be used: {error}; make "
                f"{self._path.parent} a folder that can be written to, and resume the study"
            ) from error

    @property
    def _lock_path(self) -> Path:
        return self._path / "lock"
