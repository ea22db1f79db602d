"""A check of a SQLite file for damaged pages, table by table, that can be ended at any time."""

from __future__ import annotations

import math
import sqlite3
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from urllib.parse import quote

from drivora_service.errors import StoreDamaged
from drivora_service.store.engine.storage_faults import explain_sqlite_error
from drivora_service.store.engine.store_errors import damage_name

_FIRST = ("alembic_version", "owners", "runs", "batches", "attempts", "change_epochs")
"""The tables that every start and every claim of a run reads and writes."""

_LAST = ("documents", "reports")
"""The largest tables. A damage there concerns few runs."""

_LOOK_S = 0.05
"""Seconds between two looks whether the check is to end."""


class IntegrityCheck:
    """Checks the pages of every table and of its indices, those that the queue needs first.

    It reads and writes nothing else, so that a damaged file stays as it is for a rescue. It cannot
    see a page that was replaced by another valid one, nor other bytes within a stored value: SQLite
    has no checksums.
    """

    def __init__(self, file: Path) -> None:
        """Reads nothing yet.

        Args:
            file: Path of an SQLite database.
        """
        self._file = file
        self._rest: list[str] | None = None
        self._stopped = threading.Event()

    @property
    def unchecked(self) -> tuple[str, ...]:
        """The tables that have not been checked yet."""
        # All tables are listed in the first, which a run may not have finished reading.
        return ("sqlite_master",) if self._rest is None else tuple(self._rest)

    def run(self, seconds: float = math.inf) -> bool:
        """Checks the tables that are left, for a limited time.

        Args:
            seconds: Time after which the check ends; the current table then counts as unchecked.

        Returns:
            Whether all tables are checked.

        Raises:
            StoreDamaged: The file is damaged, or no SQLite database.
        """
        until = time.monotonic() + seconds
        try:
            # With `ro`, closing writes nothing back from the write-ahead log.
            connection = sqlite3.connect(
                f"file:{quote(str(self._file))}?mode=ro", uri=True, check_same_thread=False
            )
            with closing(connection), self._interrupted_after(connection, until):
                self._check(connection)
        except sqlite3.Error as error:
            if damage_name(error):
                raise self._damaged(str(error), damage_name(error)) from error
            # It was interrupted; or it cannot be read, which the code that opens it explains.
        return self._rest == []

    def stop(self) -> None:
        """Ends the check, which may run in another thread, for good."""
        self._stopped.set()

    def _check(self, connection: sqlite3.Connection) -> None:
        if self._rest is None:
            found = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
            tables = [name for (name,) in found]
            tables.sort(key=lambda name: (name in _LAST, name not in _FIRST))
            self._rest = ["sqlite_master", *tables]
        while self._rest:
            # The pragma without a table would check all of them in one statement.
            name = self._rest[0].replace('"', '""')
            for (message,) in connection.execute(f'PRAGMA quick_check("{name}")'):
                if message != "ok":
                    raise self._damaged(" ".join(message.split()), "SQLITE_CORRUPT")
            self._rest.pop(0)

    @contextmanager
    def _interrupted_after(self, connection: sqlite3.Connection, until: float) -> Iterator[None]:
        """Interrupts the statement of a connection at a time, or when the check is to end."""
        ended = threading.Event()

        def watch() -> None:
            while not ended.wait(_LOOK_S):
                # Each time anew: it has no effect between two statements. SQLite's handler of
                # progress would do, but is called every few seconds only.
                if self._stopped.is_set() or time.monotonic() >= until:
                    connection.interrupt()

        watcher = threading.Thread(target=watch, name="integrity-deadline", daemon=True)
        watcher.start()
        try:
            yield
        finally:
            ended.set()
            watcher.join()

    def _damaged(self, found: str, name: str) -> StoreDamaged:
        return StoreDamaged(
            f"the database is damaged: {found}: {explain_sqlite_error(self._file, name)}"
        )
