"""One server a data folder."""

from __future__ import annotations

from pathlib import Path

from drivora_service.store.file_lock import FileLock


class ServerLock:
    """Holds a data folder for this process.

    So a server that has it knows that every other owner of leases in its database is dead.
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
        """Lets go of the folder."""
        self._lock.release()
