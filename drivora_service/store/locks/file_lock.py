"""Locks that are released when their process dies."""

from __future__ import annotations

import errno
import fcntl
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import Timeout, UnixFileLock

from drivora_service.errors import Conflict, StoreError
from drivora_service.store.engine.storage_faults import make_folder_error

_WAIT_S, _PAUSE_S = 0.2, 0.01
"""Seconds to wait for a lock, and seconds between two attempts."""

_WITHOUT_LOCKS = (errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP)
"""What file systems answer that cannot lock files."""


class FileLock:
    """A lock on a file, held by this process.

    The operating system releases it when the process dies, however it dies. The file stays, with
    the id of the last process that held it.
    """

    def __init__(self, path: Path, *, refusal: Callable[[str], str]) -> None:
        """Takes the lock; waits a moment for processes that only check it.

        Args:
            path: Path of the file, which is made, with its folder, if it does not exist.
            refusal: Returns the message of the error, given the id of the process that holds it.

        Raises:
            Conflict: Another process has it.
            StoreError: The file cannot be made or written, or its file system cannot lock files.
        """
        self._lock = UnixFileLock(
            path,
            timeout=_WAIT_S,
            poll_interval=_PAUSE_S,
            mode=0o600,
            # Another thread than the one that took it may release it.
            thread_local=False,
            # A lock by the mere existence of a file would outlive a killed process.
            fallback_to_soft=False,
            preserve_lock_file=True,
            on_acquired=_write_process_id,
        )
        try:
            with _convert_lock_errors(path):
                self._lock.acquire()
        except Timeout:
            raise Conflict(refusal(holder_of(path))) from None

    def release(self) -> None:
        """Releases the lock."""
        self._lock.release()


def holder_of(path: Path) -> str:
    """Returns the id of the process that holds, or has held, the lock of a file."""
    try:
        return path.read_text(errors="replace").strip() or "(unknown)"
    except FileNotFoundError:
        return "(unknown)"


def is_locked(path: Path) -> bool:
    """Returns whether a process holds the lock of an existing file; does not change the file.

    Raises:
        StoreError: The file cannot be read, or its file system cannot lock files.
    """
    with _convert_lock_errors(path):
        file = os.open(path, os.O_RDONLY)
    try:
        # Shared, so that several processes may check; meanwhile the lock cannot be taken.
        with _convert_lock_errors(path):
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(file)
    return False


@contextmanager
def _convert_lock_errors(path: Path) -> Iterator[None]:
    try:
        yield
    except (Timeout, BlockingIOError, FileNotFoundError):
        raise
    except OSError as error:
        if error.errno not in _WITHOUT_LOCKS:
            raise make_folder_error(path.parent, error) from error
        raise StoreError(
            f"the file system of {path.parent} cannot lock files ({error.strerror}); choose "
            "another folder with DRIVORA_DATA_DIR, or have it mounted with locks (Lustre: `flock`)"
        ) from error


def _write_process_id(file: int) -> None:
    os.ftruncate(file, 0)
    os.write(file, str(os.getpid()).encode())
