"""Notices that the file of an SQLite database was moved, removed or replaced while it is used."""

from __future__ import annotations

import os
from pathlib import Path

from drivora_service.errors import StoreDamaged, StoreUnavailable

_UNKNOWN = (-1, -1)
_LOG_SUFFIX = "-wal"


class FileWatch:
    """Compares the file at a database's path with the one that was there at first.

    A process that has a database open writes to the file that it opened, wherever that is now, and
    opens further connections to what is at the path: accepted work would go to both, and some of it
    be lost.
    """

    def __init__(self, file: Path) -> None:
        """Remembers the file.

        Args:
            file: Path of an SQLite database that is open, or is made by its first connection.
        """
        self._file = file
        self._log = file.with_name(file.name + _LOG_SUFFIX)
        self._first = _identity(file)

    def check(self) -> None:
        """Refuses work on a file that is not the one that was there at first.

        Raises:
            StoreUnavailable: No file is there, which may come back, as a volume does.
            StoreDamaged: Another file is there.
        """
        found = _identity(self._file)
        if self._first in (None, _UNKNOWN):
            # A new database, which the first connection has made; or its storage did not answer.
            self._first = found
        if found == self._first or _UNKNOWN in (found, self._first):
            return
        if found is None:
            raise StoreUnavailable(
                f"{self._file} was moved or removed while it is used: put it back, with its "
                f"{self._log.name}"
            )
        raise StoreDamaged(
            f"{self._file} was replaced by another file while it is used, and nothing is stored "
            f"any more: stop what uses it, put the right file there, with its {self._log.name}, or "
            "restore a backup, and start it again"
        )

    def describe_lost_log(self) -> str:
        """Returns that the write-ahead log is not there, and what to do; "" while it is.

        For moments at which a transaction is open, so that SQLite has not removed it itself.
        """
        if os.path.lexists(self._log):
            return ""
        return (
            f"{self._log} was removed while it is used, and nothing is stored any more: stop what "
            "uses the database with SIGTERM, which still moves the newest changes into its file, "
            "then run `drivora store verify`, and start it again"
        )


def _identity(file: Path) -> tuple[int, int] | None:
    """Returns what tells a file from all others; ``None``: none is there."""
    try:
        status = file.stat()
    except FileNotFoundError:
        return None
    except OSError:
        # A storage that does not answer has not lost its files.
        return _UNKNOWN
    return status.st_dev, status.st_ino
