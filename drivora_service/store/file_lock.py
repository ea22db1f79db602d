"""Locks that die with their process."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Callable
from pathlib import Path

from filelock import Timeout, UnixFileLock

from drivora_service.errors import Conflict

_WAIT_S, _PAUSE_S = 0.2, 0.01
"""Seconds for which a lock is waited for, and between two attempts."""


class FileLock:
    """Holds a file for this process.

    The operating system lets go of it when the process dies, however it dies. The file stays, with
    the id of the process that had it last.
    """

    def __init__(self, path: Path, *, refusal: Callable[[str], str]) -> None:
        """Takes the lock; processes that only look have let go of it a moment later.

        Args:
            path: Of the file, which is made, with its folder, if it does not exist.
            refusal: Returns the message of the error, from the id of the process that has it.

        Raises:
            Conflict: Another process has it.
        """
        self._lock = UnixFileLock(
            path,
            timeout=_WAIT_S,
            poll_interval=_PAUSE_S,
            mode=0o600,
            # It may be released by another thread than the one that took it.
            thread_local=False,
            # A file that exists, instead of a lock on it, would outlive a process that is killed.
            fallback_to_soft=False,
            preserve_lock_file=True,
            on_acquired=_write_process_id,
        )
        try:
            self._lock.acquire()
        except Timeout:
            holder = path.read_text(errors="replace").strip()
            raise Conflict(refusal(holder or "(unknown)")) from None

    def release(self) -> None:
        """Lets go of the file."""
        self._lock.release()


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


def _write_process_id(file: int) -> None:
    os.ftruncate(file, 0)
    os.write(file, str(os.getpid()).encode())
