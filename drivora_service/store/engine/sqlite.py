"""Connections and transactions of SQLite."""

from __future__ import annotations

import sqlite3
from functools import partial

from sqlalchemy import URL, Connection, Engine, create_engine, event

_MOST_CACHED = 16 << 20
"""Bytes of the pages that a process keeps; the system keeps the file itself."""


def sqlite_engine(url: URL, *, patience_s: float) -> Engine:
    """Returns an engine whose transactions have consistent views and survive a loss of power.

    Args:
        url: Address of a file.
        patience_s: Seconds to wait for other processes that write.
    """
    engine = create_engine(url, pool_size=16, max_overflow=48)
    event.listen(engine, "connect", partial(_configure, patience_s))
    event.listen(engine, "begin", _begin)
    return engine


def _configure(patience_s: float, connection: sqlite3.Connection, _record: object) -> None:
    # sqlite3 itself would begin transactions too late for consistent reads.
    connection.isolation_level = None
    cursor = connection.cursor()
    try:
        # Before the first write, else only a rewritten file could shrink; later it is a write, for
        # which a reader must not wait.
        if cursor.execute("PRAGMA page_count").fetchone() == (0,):
            cursor.execute("PRAGMA auto_vacuum = INCREMENTAL")
        cursor.execute("PRAGMA journal_mode = WAL")
        # FULL: what was answered with 202 also survives a loss of power.
        cursor.execute("PRAGMA synchronous = FULL")
        cursor.execute("PRAGMA foreign_keys = ON")
        cursor.execute(f"PRAGMA busy_timeout = {round(1000 * patience_s)}")
        cursor.execute("PRAGMA cache_size = -65536")
        # Of all connections of the process; else each grows with the database up to that size.
        cursor.execute(f"PRAGMA soft_heap_limit = {_MOST_CACHED}")
    except sqlite3.Error:
        # The pool does not own the connection yet, so nothing else would close it.
        connection.close()
        raise
    cursor.close()


def _begin(connection: Connection) -> None:
    # A transaction that reads first and writes later would fail if another wrote in between.
    writes = connection.get_execution_options().get("drivora_writes", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")
