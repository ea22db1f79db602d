"""The folder of one server in a data folder that several servers may share."""

from __future__ import annotations

import re
import socket
from itertools import count
from pathlib import Path

from drivora_service.errors import Conflict
from drivora_service.store.server_lock import ServerLock

_MOST = 10_000


class ServerFolder:
    """What a server has for itself in a data folder: its lock, and the logs of its workers.

    On SQLite that is the data folder, which one server has at a time. On a database of a server of
    its own, several servers share the data folder, and each takes a folder ``servers/HOST-NUMBER``
    that no other one has; after a restart, it is that of before.

    Attributes:
        path: The folder.
    """

    def __init__(self, data_dir: Path, *, is_shared: bool) -> None:
        """Takes a folder and locks it.

        Args:
            data_dir: Data folder.
            is_shared: Whether several servers may use it.

        Raises:
            Conflict: Another process serves the data folder, and it is not shared.
        """
        if not is_shared:
            self.path, self._lock = data_dir, ServerLock(data_dir)
            return
        host = re.sub(r"[^A-Za-z0-9.-]", "-", socket.gethostname()) or "host"
        for number in count(1):
            self.path = data_dir / "servers" / f"{host}-{number}"
            try:
                self._lock = ServerLock(self.path)
            except Conflict:
                if number >= _MOST:
                    raise
            else:
                return

    def release(self) -> None:
        """Releases the lock."""
        self._lock.release()
