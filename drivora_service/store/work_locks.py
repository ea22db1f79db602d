"""Locks on pieces of long work, each done by one process at a time.

They are released when their process dies, however it dies, on whichever machine: the next process
need not wait until it is taken for dead. On PostgreSQL they are session locks of one connection, on
SQLite locks of files beside the database.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import socket
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Protocol

from sqlalchemy import Connection, Engine, text
from sqlalchemy.exc import DBAPIError

from drivora_service.errors import Conflict, StoreError
from drivora_service.store.file_lock import FileLock, is_locked
from drivora_service.store.store_errors import store_errors


class WorkKind(StrEnum):
    """Kinds of work that one process does at a time."""

    CAMPAIGN = "campaign"
    STUDY = "study"
    MINIMIZATION = "minimisation"
    HOUSEKEEPING = "housekeeping"
    SERVER = "server"
    """A server; not work, but known in the same way."""


_NUMBERS = {kind: 0x64720000 + number for number, kind in enumerate(WorkKind)}
"""First number of the advisory locks of each kind: "dr", and the kind."""


@dataclass(frozen=True, slots=True)
class LongWork:
    """A piece of work.

    Attributes:
        kind: What it is.
        id: Its id.
    """

    kind: WorkKind
    id: str

    @classmethod
    def campaign(cls, campaign_id: str) -> LongWork:
        """Returns the work on a campaign."""
        return cls(WorkKind.CAMPAIGN, campaign_id)

    @classmethod
    def server(cls, owner_id: str) -> LongWork:
        """Returns what a server holds for as long as it lives."""
        return cls(WorkKind.SERVER, owner_id)

    @classmethod
    def minimization(cls, minimization_id: str) -> LongWork:
        """Returns the work of a service on a minimisation."""
        return cls(WorkKind.MINIMIZATION, minimization_id)

    @classmethod
    def study(cls, study_id: str) -> LongWork:
        """Returns the work of a command on a study."""
        return cls(WorkKind.STUDY, study_id)

    def __str__(self) -> str:
        return f"{self.kind} {self.id}"


class HeldWork(Protocol):
    """A lock that this process holds."""

    def release(self) -> None:
        """Releases the lock."""


class WorkLocks(Protocol):
    """The locks of one database."""

    def hold(self, work: LongWork) -> HeldWork:
        """Locks a piece of work for this process.

        Raises:
            Conflict: A process does it already.
            StoreError: Nothing can be locked.
        """

    def is_held(self, work: LongWork) -> bool:
        """Returns whether a process does a piece of work.

        Raises:
            StoreError: It cannot be known.
        """

    def is_any_held(self, kind: WorkKind) -> bool:
        """Returns whether a process does any work of a kind.

        Raises:
            StoreError: It cannot be known.
        """

    def keep(self) -> None:
        """Takes the held locks again if they were lost with their connection.

        Raises:
            StoreError: The database cannot be used now.
        """

    def close(self) -> None:
        """Releases all locks."""


class FileWorkLocks:
    """Locks of files, for processes on one machine."""

    def __init__(self, folder: Path) -> None:
        """Takes the folder of the files, which is made with the first of them."""
        self._folder = folder

    def hold(self, work: LongWork) -> FileLock:
        """Locks a piece of work, as ``WorkLocks`` says."""
        try:
            return FileLock(
                self._path(work), refusal=lambda holder: _refusal(work, f"process {holder}")
            )
        except OSError as error:
            raise StoreError(
                f"{work} cannot be locked: {error}; make {self._folder} a folder that can be "
                "written to, and try again"
            ) from error

    def is_held(self, work: LongWork) -> bool:
        """Returns whether a process does a piece of work."""
        path = self._path(work)
        return path.is_file() and is_locked(path)

    def is_any_held(self, kind: WorkKind) -> bool:
        """Returns whether a process does any work of a kind."""
        return any(map(is_locked, self._folder.glob(f"{kind}-*.lock")))

    def keep(self) -> None:
        """Does nothing: the system takes no lock from a living process."""

    def close(self) -> None:
        """Does nothing: the locks end with the process."""

    def _path(self, work: LongWork) -> Path:
        return self._folder / f"{work.kind}-{work.id}.lock"


class PostgresqlWorkLocks:
    """Session locks of one connection of this process.

    The server releases them when the connection ends: at the death of the process, or, if its
    machine is gone, once it does not answer for half a minute.
    """

    def __init__(self, engine: Engine) -> None:
        """Connects with the first lock."""
        self._engine = engine
        self._using = threading.Lock()
        self._connection: Connection | None = None
        self._held: set[LongWork] = set()

    def hold(self, work: LongWork) -> HeldWork:
        """Locks a piece of work, as ``WorkLocks`` says."""
        with self._using:
            if work in self._held:
                raise Conflict(_refusal(work, f"process {os.getpid()}"))
            with self._connected() as connection:
                if not connection.scalar(_TRY, _key(work)):
                    holder = connection.scalar(_HOLDER, _key(work)) or "another process"
                    raise Conflict(_refusal(work, holder))
            self._held.add(work)
        return _Held(self, work)

    def is_held(self, work: LongWork) -> bool:
        """Returns whether a process does a piece of work."""
        with store_errors(), self._engine.connect() as connection:
            return connection.scalar(_HOLDER, _key(work)) is not None

    def is_any_held(self, kind: WorkKind) -> bool:
        """Returns whether a process does any work of a kind."""
        with store_errors(), self._engine.connect() as connection:
            return bool(connection.scalar(_ANY, {"kind": _NUMBERS[kind]}))

    def keep(self) -> None:
        """Takes the held locks again if their connection was lost, unless others have them now."""
        with self._using:
            if self._held:
                with self._connected() as connection:
                    connection.scalar(text("SELECT 1"))

    def close(self) -> None:
        """Releases all locks."""
        with self._using:
            self._held.clear()
            self._disconnect()

    def release(self, work: LongWork) -> None:
        """Releases a lock; a lost connection has released it."""
        with self._using:
            self._held.discard(work)
            if self._connection is None:
                return
            try:
                self._connection.scalar(_UNLOCK, _key(work))
            except DBAPIError:
                self._disconnect()

    @contextlib.contextmanager
    def _connected(self) -> Iterator[Connection]:
        with store_errors():
            connection = self._live_connection()
            try:
                yield connection
            except DBAPIError:
                self._disconnect()
                raise

    def _live_connection(self) -> Connection:
        if self._connection is not None:
            try:
                self._connection.scalar(text("SELECT 1"))
            except DBAPIError:
                self._disconnect()
            else:
                return self._connection
        connection = self._engine.connect().execution_options(isolation_level="AUTOCOMMIT")
        # Not of the pool: it lives as long as the locks.
        connection.detach()
        self._connection = connection
        try:
            connection.execute(_SETTINGS, {"name": _name()})
            for work in self._held:
                connection.scalar(_TRY, _key(work))
        except DBAPIError:
            self._disconnect()
            raise
        return connection

    def _disconnect(self) -> None:
        connection, self._connection = self._connection, None
        if connection is not None:
            with contextlib.suppress(DBAPIError):
                connection.close()


@dataclass(frozen=True, slots=True)
class _Held:
    locks: PostgresqlWorkLocks
    work: LongWork

    def release(self) -> None:
        """Releases the lock."""
        self.locks.release(self.work)


def _refusal(work: LongWork, holder: str) -> str:
    return f"{holder} is running {work} already"


def _key(work: LongWork) -> dict[str, int]:
    """Returns the two numbers of an advisory lock.

    Works of one kind share a number once in four thousand million pairs; then one of them waits.
    """
    digest = hashlib.sha256(work.id.encode()).digest()
    return {"kind": _NUMBERS[work.kind], "work": int.from_bytes(digest[:4], signed=True)}


def _name() -> str:
    """Returns how a session names its process: the server keeps 63 bytes of it."""
    return f"process {os.getpid()} on {socket.gethostname()}"[:63]


_TRY = text("SELECT pg_try_advisory_lock(CAST(:kind AS integer), CAST(:work AS integer))")
_UNLOCK = text("SELECT pg_advisory_unlock(CAST(:kind AS integer), CAST(:work AS integer))")
_LOCKS = (
    "FROM pg_locks LEFT JOIN pg_stat_activity USING (pid) WHERE locktype = 'advisory' AND granted "
    "AND database = (SELECT oid FROM pg_database WHERE datname = current_database()) "
    "AND objsubid = 2 AND CAST(classid AS bigint) = :kind"
)
_HOLDER = text(
    f"SELECT coalesce(application_name, 'another process') {_LOCKS} "
    "AND CAST(objid AS bigint) = (CAST(:work AS bigint) + 4294967296) % 4294967296"
)
_ANY = text(f"SELECT EXISTS (SELECT {_LOCKS})")
_SETTINGS = text(
    # Silence is no reason to end it, but a machine that is gone is.
    "SELECT set_config('application_name', :name, false), "
    "set_config('idle_session_timeout', '0', false), "
    "set_config('tcp_keepalives_idle', '15', false), "
    "set_config('tcp_keepalives_interval', '5', false), "
    "set_config('tcp_keepalives_count', '3', false)"
)
