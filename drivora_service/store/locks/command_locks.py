"""The commands that work on a data folder: each locks a file for as long as it lives."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable
from pathlib import Path

from drivora_service.store.locks.file_lock import FileLock, is_locked


class CommandLocks:
    """The lock files of the commands of a data folder, by their ids as owners of leases."""

    def __init__(self, data_dir: Path) -> None:
        self._folder = data_dir / "commands"

    def hold(self, owner_id: str) -> FileLock:
        """Locks the file of this command; must be called before it becomes an owner.

        Raises:
            Conflict: Another process has it, which unique ids exclude.
        """
        return FileLock(
            self._path(owner_id), refusal=lambda holder: f"process {holder} is command {owner_id}"
        )

    def is_command(self, owner_id: str) -> bool:
        """Whether an owner is a command, living or dead."""
        return self._path(owner_id).is_file()

    def dead(self, owners: Iterable[str]) -> list[str]:
        """Returns the commands among owners whose process has died.

        Args:
            owners: Owners that the database has. A command locks its file before it becomes one, so
                that a file without a lock belongs to a dead process.
        """
        return [one for one in owners if self.is_command(one) and not self._lives(one)]

    def _lives(self, owner_id: str) -> bool:
        with contextlib.suppress(FileNotFoundError):
            return is_locked(self._path(owner_id))
        return False

    def forget(self, owner_id: str) -> None:
        """Removes the file of a command that has ended."""
        self._path(owner_id).unlink(missing_ok=True)

    def _path(self, owner_id: str) -> Path:
        return self._folder / f"{owner_id}.lock"
