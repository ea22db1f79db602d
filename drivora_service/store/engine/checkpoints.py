"""Moving commits from the write-ahead log of SQLite into the file of the database."""

from __future__ import annotations

import contextlib
import sqlite3
import threading
import time
from contextlib import closing

from sqlalchemy import Engine
from sqlalchemy.exc import SQLAlchemyError

CHECKPOINT_S = 30.0
"""Seconds between two checkpoints, while there are commits: what is lost at most if the process is
killed and the log is then removed. SQLite itself makes one after 4 MB of changes, which may be
the work of an hour."""


class Checkpoints:
    """Makes checkpoints of a database, in the threads that commit. Thread-safe.

    The service commits a heartbeat every few seconds, so that checkpoints follow without a thread
    of their own. Databases of PostgreSQL make their own.
    """

    def __init__(self, engine: Engine, *, every_s: float) -> None:
        """Makes none yet.

        Args:
            engine: Of the database.
            every_s: Seconds between two checkpoints.
        """
        self._engine, self._every_s = engine, every_s
        self._is_sqlite = engine.dialect.name == "sqlite"
        self._due_at = time.monotonic() + every_s
        self._making = threading.Lock()

    def make_if_due(self) -> None:
        """Makes a checkpoint that waits for no other transaction, if the last one is long ago.

        Commits that a transaction which still reads does not see are left to the next checkpoint.
        """
        if self._is_sqlite and time.monotonic() >= self._due_at:
            self.make(truncates=False)

    def make(self, *, truncates: bool) -> None:
        """Makes a checkpoint; one that fails leaves everything in the log, and is not an error.

        Args:
            truncates: Whether to wait for other transactions, and empty the log; else those are
                not disturbed, and nothing is waited for.
        """
        # Another thread that makes one does the work of this one.
        if not self._is_sqlite or not self._making.acquire(blocking=False):
            return
        try:
            self._due_at = time.monotonic() + self._every_s
            mode = "TRUNCATE" if truncates else "PASSIVE"
            with (
                contextlib.suppress(sqlite3.Error, SQLAlchemyError),
                # Not through SQLAlchemy, which would begin a transaction.
                closing(self._engine.raw_connection()) as connection,
                closing(connection.cursor()) as cursor,
            ):
                cursor.execute(f"PRAGMA wal_checkpoint({mode})")
        finally:
            self._making.release()
