"""One server a data folder."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path

from drivora_service.errors import Conflict


class ServerLock:
    """Holds a data folder for this process.

    The operating system lets go of it when the process dies, however it dies. So a server that has
    it knows that every other owner of leases in its database is dead.
    """

    def __init__(self, data_dir: Path) -> None:
        """Takes the lock.

        Raises:
            Conflict: Another process has it.
        """
        data_dir.mkdir(parents=True, exist_ok=True)
        path = data_dir / "server.lock"
        self._file = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.read(self._file, 32).decode(errors="replace").strip()
            os.close(self._file)
            raise Conflict(
                f"process {holder or '(unknown)'} already serves {data_dir}; stop it, talk to it "
                "with --server, or choose another folder with DRIVORA_DATA_DIR"
            ) from None
        os.ftruncate(self._file, 0)
        os.write(self._file, str(os.getpid()).encode())

    def release(self) -> None:
        """Lets go of the folder."""
        os.close(self._file)
