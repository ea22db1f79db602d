"""Locks on pieces of long work by advisory locks of PostgreSQL."""

from __future__ import annotations

import contextlib
import hashlib
import os
import socket
import threading
from collections.abc import Iterator
from dataclasses import dataclass

from sqlalchemy import Connection, Engine, text
from sqlalchemy.exc import DBAPIError

from drivora_service.errors import Conflict
from drivora_service.store.engine.store_errors import store_errors
from drivora_service.store.locks.work_locks import HeldWork, LongWork, WorkKind, refusal

_NUMBERS = {kind: 0x64720000 + number for number, kind in enumerate(WorkKind)}
"""First number of the advisory locks of each kind: "dr", and the kind."""


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
        self._lost: set[LongWork] = set()
        """Held works whose locks were lost with a connection and could not be taken again yet."""

    def hold(self, work: LongWork) -> HeldWork:
        """Locks a piece of work, as ``WorkLocks`` says."""
        with self._using:
            if work in self._held:
                raise Conflict(refusal(work, f"process {os.getpid()}"))
            with self._use_connection() as connection:
                if not connection.scalar(_TRY, _key(work)):
                    holder = connection.scalar(_HOLDER, _key(work)) or "another process"
                    raise Conflict(refusal(work, holder))
            self._held.add(work)
        return _Held(self, work)

    def is_held(self, work: LongWork) -> bool:
        """Returns whether a process does a piece of work."""
        with store_errors(), self._engine.connect() as connection:
            return connection.scalar(_HOLDER, _key(work)) is not None

    def is_any_held(self, kind: WorkKind) -> bool:
        """Returns whether a process does any work of a kind."""
        return bool(self.holders(kind))

    def holders(self, kind: WorkKind) -> tuple[str, ...]:
        """Returns the names of the processes that do work of a kind."""
        with store_errors(), self._engine.connect() as connection:
            return tuple(connection.scalars(_HOLDERS, {"kind": _NUMBERS[kind]}))

    def forget(self, work: LongWork) -> None:
        """Does nothing: the server keeps nothing of a dead process."""

    def keep(self) -> None:
        """Takes lost locks again, unless others have them now; those are tried again each time.

        Also the server may have one for a while: for a session that has ended on this side only.
        """
        with self._using:
            if self._held:
                with self._use_connection() as connection:
                    self._take_lost(connection)

    def close(self) -> None:
        """Releases all locks."""
        with self._using:
            self._held.clear()
            self._disconnect()

    def release(self, work: LongWork) -> None:
        """Releases a lock; a lost connection has released it."""
        with self._using:
            self._held.discard(work)
            is_lost = work in self._lost
            self._lost.discard(work)
            if self._connection is None or is_lost:
                return
            try:
                self._connection.scalar(_UNLOCK, _key(work))
            except DBAPIError:
                self._disconnect()

    @contextlib.contextmanager
    def _use_connection(self) -> Iterator[Connection]:
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
            self._take_lost(connection)
        except DBAPIError:
            self._disconnect()
            raise
        return connection

    def _take_lost(self, connection: Connection) -> None:
        for work in tuple(self._lost):
            if connection.scalar(_TRY, _key(work)):
                self._lost.discard(work)

    def _disconnect(self) -> None:
        connection, self._connection = self._connection, None
        self._lost = set(self._held)
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
_HOLDERS = text(f"SELECT DISTINCT coalesce(application_name, 'another process') {_LOCKS}")
_SETTINGS = text(
    # Silence is no reason to end it, but a machine that is gone is.
    "SELECT set_config('application_name', :name, false), "
    "set_config('idle_session_timeout', '0', false), "
    "set_config('tcp_keepalives_idle', '15', false), "
    "set_config('tcp_keepalives_interval', '5', false), "
    "set_config('tcp_keepalives_count', '3', false)"
)
