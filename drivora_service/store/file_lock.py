"""Locks that die with their process."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Callable
from pathlib import Path

from drivora_service.errors import Conflict


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
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.read(self._file, 32).decode(errors="replace").strip()
            os.close(self._file)
            raise Conflict(refusal(holder or "(unknown)")) from None
        os.ftruncate(self._file, 0)
        os.write(self._file, str(os.getpid()).encode())

    def release(self) -> None:
        """Lets go of the file."""
        os.close(self._file)


def is_locked(path: Path) -> bool:
    """Says whether a process holds a file."""
    try:
        FileLock(path, refusal=str).release()
    except Conflict:
        return True
    return False
