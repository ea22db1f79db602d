"""Returning free pages of a SQLite file to the file system."""

from __future__ import annotations

import time
from contextlib import closing

from sqlalchemy import text

from drivora_service.errors import StoreError
from drivora_service.store.database import Database

_PAGES = 100
_INCREMENTAL = 2


def return_free_space(database: Database) -> int:
    """Shrinks the file of a database in steps, in short transactions.

    Only databases that were made by this version or later, or rewritten by
    :func:`rewrite_database`, can shrink so; others keep free pages for new rows.

    Returns:
        The bytes by which the file shrank, after a checkpoint.
    """
    if database.engine.dialect.name != "sqlite":
        return 0
    with database.read() as transaction:
        session = transaction.session
        if session.scalar(text("PRAGMA auto_vacuum")) != _INCREMENTAL:
            return 0
        free = session.scalar(text("PRAGMA freelist_count")) or 0
        page_bytes = session.scalar(text("PRAGMA page_size")) or 0
    for _ in range(0, free, _PAGES):
        with database.write() as transaction:
            begun = time.perf_counter()
            for _ in range(_PAGES):
                transaction.session.execute(text("PRAGMA incremental_vacuum(1)"))
        time.sleep(min(time.perf_counter() - begun, 0.1))
    return int(free * page_bytes)


def refuse_rewriting(database: Database) -> None:
    """Refuses to rewrite what is no file.

    Raises:
        StoreError: The database is not SQLite's.
    """
    if database.engine.dialect.name != "sqlite":
        raise StoreError(
            "only SQLite databases are rewritten here; PostgreSQL uses free space again by itself, "
            "and returns it to the file system with VACUUM FULL"
        )


def rewrite_database(database: Database) -> None:
    """Rewrites a SQLite file without free pages, so that it can shrink from now on.

    Needs as much free space as the database takes; other processes can read and not write
    meanwhile.

    Raises:
        StoreError: The database is not SQLite's.
    """
    refuse_rewriting(database)
    with closing(database.engine.raw_connection()) as connection:
        # Not through SQLAlchemy, which would begin a transaction.
        cursor = connection.cursor()
        cursor.execute("PRAGMA auto_vacuum = INCREMENTAL")
        cursor.execute("VACUUM")
        cursor.close()
