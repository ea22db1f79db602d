"""The lock that allows one server a data folder."""

from __future__ import annotations

from pathlib import Path

from drivora_service.store.file_lock import FileLock


class ServerLock:
    """A lock on a data folder, held by this process.

    A server that holds it knows that every other server on its database is dead. Commands do not
    take it: they may hold leases at the same time, and each has a lock of its own
    (``CommandLocks``).
    """

    def __init__(self, data_dir: Path) -> None:
        """Takes the lock.

        Raises:
            Conflict: Another process has it.
        """
        self._lock = FileLock(
            data_dir / "server.lock",
            refusal=lambda holder: (
                f"process {holder} already serves {data_dir}; stop it, talk to it with --server, "
                "or choose another folder with DRIVORA_DATA_DIR"
            ),
        )

    def release(self) -> None:
        """Releases the lock."""
        self._lock.release()
