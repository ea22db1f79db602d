"""Locks that die with their process."""

from __future__ import annotations

import fcntl
import os
import time
from collections.abc import Callable
from pathlib import Path

from drivora_service.errors import Conflict

_ATTEMPTS, _PAUSE_S = 20, 0.01


class FileLock:
    """Holds a file for this process.

    The operating system lets go of it when the process dies, however it dies.
    """

    def __init__(self, path: Path, *, refusal: Callable[[str], str]) -> None:
        """Takes the lock.

        Args:
            path: Of the file, which is made, with its folder, if it does not exist.
            refusal: Gives the message of the error, from the id of the process that has it.

        Raises:
            Conflict: Another process has it.
        """
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
        if not _take(self._file):
            holder = os.read(self._file, 32).decode(errors="replace").strip()
            os.close(self._file)
            raise Conflict(refusal(holder or "(unknown)"))
        os.ftruncate(self._file, 0)
        os.write(self._file, str(os.getpid()).encode())

    def release(self) -> None:
        """Lets go of the file."""
        os.close(self._file)


def is_locked(path: Path) -> bool:
    """Whether a process holds a file, which exists. Looking leaves the file as it is."""
    file = os.open(path, os.O_RDONLY)
    try:
        # Shared, so that several may look; for this moment the file cannot be taken.
        fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(file)
    return False


def _take(file: int) -> bool:
    """Takes a lock; processes that only look have let go of it a moment later."""
    for attempt in range(_ATTEMPTS):
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            time.sleep(_PAUSE_S if attempt < _ATTEMPTS - 1 else 0.0)
        else:
            return True
    return False
