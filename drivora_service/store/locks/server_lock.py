"""The lock that allows one server a data folder."""

from __future__ import annotations

from pathlib import Path

from drivora_service.errors import Conflict
from drivora_service.store.locks.file_lock import FileLock, holder_of, is_locked

_NAME = "server.lock"


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
            data_dir / _NAME,
            refusal=lambda holder: (
                f"process {holder} already serves {data_dir}; stop it, talk to it with --server, "
                "or choose another folder with DRIVORA_DATA_DIR"
            ),
        )

    def release(self) -> None:
        """Releases the lock."""
        self._lock.release()


def serving_process(data_dir: Path) -> str | None:
    """Returns the id of the process that serves a data folder; ``None`` if none does.

    Servers that share a folder, on a database of a server of its own, are not found.
    """
    path = data_dir / _NAME
    return holder_of(path) if path.is_file() and is_locked(path) else None


def refuse_while_served(data_dir: Path) -> None:
    """Refuses to migrate a database that a server uses.

    A server keeps its database at its own schema: one that uses an older schema is of an older
    version, and cannot work with the newer one.

    Raises:
        Conflict: A server has the data folder.
    """
    process = serving_process(data_dir)
    if process is not None:
        raise Conflict(
            f"process {process} serves {data_dir} with an older version of Drivora, and "
            "this version would migrate its database; stop it first, or ask it with --server"
        )
