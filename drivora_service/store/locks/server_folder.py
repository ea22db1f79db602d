"""The folder of one server in a data folder that several servers may share."""

from __future__ import annotations

import contextlib
import re
import shutil
import socket
import time
from collections.abc import Iterable
from itertools import chain
from pathlib import Path

from drivora_service.errors import Conflict
from drivora_service.store.locks.server_lock import ServerLock

_MOST = 10_000
_LOGS = "workers"
_KEPT_S = 7 * 86_400.0
"""Seconds for which what other servers and nodes have left is kept: hosts and nodes of a cluster
have new names with every start."""


class ServerFolder:
    """What a server has for itself in a data folder: its lock, and the logs of its workers.

    On SQLite that is the data folder, which one server has at a time. On a database of a server of
    its own, several servers share the data folder, and each takes a folder ``servers/HOST-NUMBER``
    that no other one has; after a restart on the same host, it is that of before. Those that no
    server has used for a week are removed, and so are the logs of nodes of a cluster.

    Attributes:
        path: The folder.
        logs: Folder of the logs of its workers.
    """

    def __init__(self, data_dir: Path, *, is_shared: bool) -> None:
        """Takes a folder and locks it.

        Args:
            data_dir: Data folder.
            is_shared: Whether several servers may use it.

        Raises:
            Conflict: Another process serves the data folder, and it is not shared.
        """
        self.path, self._lock = (
            _lock_folder(data_dir) if is_shared else (data_dir, ServerLock(data_dir))
        )
        self.logs = self.path / _LOGS
        if is_shared:
            _remove_unused(self.path.parent.iterdir())
        if self.logs.is_dir():
            _remove_old(self.logs.iterdir())

    def release(self) -> None:
        """Releases the lock."""
        self._lock.release()


def _lock_folder(data_dir: Path) -> tuple[Path, ServerLock]:
    """Returns a folder that no other server has, locked."""
    host = re.sub(r"[^A-Za-z0-9.-]", "-", socket.gethostname()) or "host"
    number = 1
    while True:
        path = data_dir / "servers" / f"{host}-{number}"
        try:
            return path, ServerLock(path)
        except Conflict:
            if number >= _MOST:
                raise
            number += 1


def _remove_unused(folders: Iterable[Path]) -> None:
    """Removes folders of servers that none has used for long."""
    for folder in filter(_is_old, folders):
        with contextlib.suppress(Conflict, OSError):
            lock = ServerLock(folder)
            shutil.rmtree(folder, ignore_errors=True)
            lock.release()


def _remove_old(folders: Iterable[Path]) -> None:
    for folder in filter(_is_old, folders):
        shutil.rmtree(folder, ignore_errors=True)


def _is_old(folder: Path) -> bool:
    """Returns whether nothing in a folder was changed for long; files are not removed."""
    if not folder.is_dir():
        return False
    changed = [0.0]
    for path in chain((folder,), folder.rglob("*")):
        with contextlib.suppress(OSError):
            changed.append(path.stat().st_mtime)
    return max(changed) < time.time() - _KEPT_S
