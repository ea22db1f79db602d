"""Locks on pieces of long work by files beside a database of SQLite."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from drivora_service.errors import StoreError
from drivora_service.store.locks.file_lock import FileLock, holder_of, is_locked
from drivora_service.store.locks.work_locks import HeldWork, LongWork, WorkKind, refusal


class FileWorkLocks:
    """Locks of files, for processes on one machine."""

    def __init__(self, folder: Path) -> None:
        """Takes the folder of the files, which is made with the first of them."""
        self._folder = folder

    def hold(self, work: LongWork) -> HeldWork:
        """Locks a piece of work, as ``WorkLocks`` says."""
        path = self._path(work)
        try:
            lock = FileLock(path, refusal=lambda holder: refusal(work, f"process {holder}"))
        except OSError as error:
            raise StoreError(
                f"{work} cannot be locked: {error}; make {self._folder} a folder that can be "
                "written to, and try again"
            ) from error
        return _HeldOnce(lock, path) if work.kind is WorkKind.COMMAND else lock

    def is_held(self, work: LongWork) -> bool:
        """Returns whether a process does a piece of work."""
        return _is_locked_file(self._path(work))

    def is_any_held(self, kind: WorkKind) -> bool:
        """Returns whether a process does any work of a kind."""
        return any(map(_is_locked_file, self._files(kind)))

    def holders(self, kind: WorkKind) -> tuple[str, ...]:
        """Returns the names of the processes that do work of a kind."""
        locked = filter(_is_locked_file, self._files(kind))
        return tuple(sorted({f"process {holder_of(path)}" for path in locked}))

    def forget(self, work: LongWork) -> None:
        """Removes the file of a dead process."""
        self._path(work).unlink(missing_ok=True)

    def keep(self) -> None:
        """Does nothing: the system takes no lock from a living process."""

    def close(self) -> None:
        """Does nothing: the locks end with the process."""

    def _files(self, kind: WorkKind) -> Iterator[Path]:
        return self._folder.glob(f"{kind}-*.lock")

    def _path(self, work: LongWork) -> Path:
        return self._folder / f"{work.kind}-{work.id}.lock"


@dataclass(frozen=True, slots=True)
class _HeldOnce:
    """A lock that is taken once, by a process of a unique id: its file ends with it."""

    lock: FileLock
    path: Path

    def release(self) -> None:
        """Removes the file and releases the lock."""
        self.path.unlink(missing_ok=True)
        self.lock.release()


def _is_locked_file(path: Path) -> bool:
    # Files of commands are removed at any time.
    with contextlib.suppress(FileNotFoundError):
        return is_locked(path)
    return False
