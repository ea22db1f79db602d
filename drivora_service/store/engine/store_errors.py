"""Errors of SQLAlchemy and of the drivers, as errors of the store."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy.exc import DBAPIError, OperationalError, SQLAlchemyError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError

from drivora_service.errors import StoreError, StoreUnavailable

_PASSING_STATES = ("25006", "25P03", "25P04", "53", "57")
"""Prefixes of the SQLSTATEs of PostgreSQL that pass, of errors that are not called operational: a
server that only reads since it is a standby, time limits, resources, and a server that stops."""


@contextmanager
def store_errors() -> Iterator[None]:
    """Raises errors of the database as errors of the store.

    Raises:
        StoreUnavailable: The error is due to the storage, to the connection, or to concurrent users
            of the database.
        StoreError: It is another one.
    """
    try:
        yield
    except SQLAlchemyError as error:
        if _passes(error):
            raise StoreUnavailable(f"the database cannot be used now: {_reason(error)}") from error
        raise StoreError(f"the database cannot be used: {error}") from error


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
    return str(error.orig).strip() if isinstance(error, DBAPIError) else str(error)
