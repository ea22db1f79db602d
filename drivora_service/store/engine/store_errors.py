"""Errors of SQLAlchemy and of the drivers, as errors of the store."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy.exc import DBAPIError, OperationalError, SQLAlchemyError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError

from drivora_service.errors import StoreDamaged, StoreError, StoreUnavailable
from drivora_service.store.engine.damage_latch import DamageLatch
from drivora_service.store.engine.storage_faults import explain_sqlite_error

_PASSING_STATES = ("25006", "25P03", "25P04", "53", "57")
"""Prefixes of the SQLSTATEs of PostgreSQL that pass, of errors that are not called operational: a
server that only reads since it is a standby, time limits, resources, and a server that stops."""

_DAMAGED_STATES = ("XX001", "XX002")
"""The SQLSTATEs of PostgreSQL for damaged data and for a damaged index."""

_DAMAGED_NAMES = ("SQLITE_CORRUPT", "SQLITE_NOTADB")
"""Prefixes of the names of SQLite's error codes for a damaged file."""

_DAMAGED_TEXT = "Could not decode to UTF-8"
"""Beginning of Python's message for a text with other bytes than those that were stored."""

_RESTORE_POSTGRESQL = (
    "PostgreSQL finds its own files damaged; stop the service, restore the database from a backup "
    "(`pg_restore`), `drivora store verify`, and start the service again"
)


@contextmanager
def store_errors(file: Path | None = None, damage: DamageLatch | None = None) -> Iterator[None]:
    """Raises errors of the database as errors of the store.

    Messages have neither statements nor values; the errors of SQLAlchemy, which have them, are the
    causes.

    Args:
        file: Path of an SQLite database, for messages; ``None``: it is none, or unknown.
        damage: Keeps a damage that is found.

    Raises:
        StoreDamaged: The database is damaged.
        StoreUnavailable: The error is due to the storage, to the connection, or to concurrent users
            of the database.
        StoreError: It is another one.
    """
    try:
        yield
    except SQLAlchemyError as error:
        reason = _reason(error)
        name = getattr(getattr(error, "orig", None), "sqlite_errorname", "")
        damaged = damage_name(error)
        if damaged:
            explained = _RESTORE_POSTGRESQL if file is None else explain_sqlite_error(file, damaged)
            # PostgreSQL adds lines about where it was.
            message = f"the database is damaged: {' '.join(reason.split())}: {explained}"
            if damage is not None:
                damage.note(message)
            raise StoreDamaged(message) from error
        explained = "" if file is None else explain_sqlite_error(file, name)
        advice = f": {explained}" if explained else ""
        if _passes(error):
            raise StoreUnavailable(f"the database cannot be used now: {reason}{advice}") from error
        raise StoreError(f"the database cannot be used: {reason}{advice}") from error


def damage_name(error: BaseException) -> str:
    """Returns the name of SQLite's error code, or the SQLSTATE, of a damage; "" if it is none.

    Args:
        error: Of SQLAlchemy or a driver.
    """
    cause = error.orig if isinstance(error, DBAPIError) else error
    name = getattr(cause, "sqlite_errorname", None) or ""
    if name.startswith(_DAMAGED_NAMES):
        return str(name)
    if isinstance(cause, sqlite3.OperationalError) and str(cause).startswith(_DAMAGED_TEXT):
        return "SQLITE_CORRUPT"
    state = getattr(cause, "sqlstate", None) or ""
    return str(state) if state in _DAMAGED_STATES else ""


def _passes(error: SQLAlchemyError) -> bool:
    if not isinstance(error, DBAPIError):
        return isinstance(error, PoolTimeoutError)
    if isinstance(error, OperationalError):
        # SQLite reports a wrong statement by the same class, as plain SQLITE_ERROR.
        return getattr(error.orig, "sqlite_errorname", "") != "SQLITE_ERROR"
    state = getattr(error.orig, "sqlstate", None) or ""
    return error.connection_invalidated or state.startswith(_PASSING_STATES)


def _reason(error: SQLAlchemyError) -> str:
    """Returns the driver's message, without the statement and its values."""
    if isinstance(error, DBAPIError):
        return str(error.orig).strip()
    # Of its lines, the first is the message; the others are the statement and a web address.
    return (str(error).splitlines() or [type(error).__name__])[0]
