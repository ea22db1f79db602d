"""This process as an owner of leases: its heartbeat, and the leases of dead processes."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime

import structlog

from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.runs.slot_state import SlotState
from drivora_service.store.database import Database
from drivora_service.store.engine.ids import new_id
from drivora_service.store.locks.command_locks import CommandLocks
from drivora_service.store.locks.file_lock import FileLock
from drivora_service.store.locks.work_locks import HeldWork, LongWork
from drivora_service.store.migration import refuse_other_schema

HEARTBEAT_TIMEOUT_S = 30.0
"""Seconds without a heartbeat after which the runs of another server, or of a command with another
data folder, are taken over."""

LOCK_TIMEOUT_S = 6.0
"""The same for one that does not hold its lock either: its process has ended, or has lost its
connection, which it notices with its next heartbeat."""

_LONGEST_PAUSE_S = 6.0
"""Seconds between two looks after which all servers are observed anew: this one was stopped, or the
database was away, and the others may have been as well."""

_log = structlog.get_logger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Heartbeat:
    """A heartbeat of another server, and when it was first seen, by the clock of this process."""

    heartbeat: datetime
    at: float


class Ownership:
    """This process as an owner of leases: a server, or a command with runs of its own.

    Another server is alive while its heartbeat changes, in seconds of this process's own clock: the
    times in the database are of clocks that may jump. It also holds a lock of the database, so that
    its death is noticed sooner. A command is alive while the file that it has locked in the data
    folder is locked; one with another data folder is judged as a server is, by its lock of the
    database. Runs of a dead server go back to the queue; runs of a dead command are cancelled.
    """

    def __init__(
        self,
        database: Database,
        policy: RetryPolicy,
        commands: CommandLocks,
        *,
        exclusive: bool = False,
        is_command: bool = False,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Creates the record and locks nothing; :meth:`register` makes this process an owner.

        Args:
            database: Holds the leases.
            policy: Decides what follows for runs that are taken over.
            commands: Locks of the live commands.
            exclusive: Whether every other server is known to be dead.
            is_command: Whether this process is a command; it takes over no runs of servers.
            clock: Returns seconds that never go backwards.
        """
        self._database, self._policy, self._commands = database, policy, commands
        self._exclusive, self._is_command, self._clock = exclusive, is_command, clock
        self._seen: dict[str, _Heartbeat] = {}
        self._looked_at = clock()
        self._lock: FileLock | None = None
        self._work_lock: HeldWork | None = None
        self.owner_id = new_id()

    @property
    def reserved_to(self) -> str:
        """Process for which the claimed runs are reserved; "" for runs of any server."""
        return self.owner_id if self._is_command else ""

    def register(self) -> None:
        """Makes this process an owner and takes over the runs of processes known to be dead.

        Raises:
            Conflict: A newer version has migrated the database.
            StoreError: The database cannot be used.
        """
        locks = self._database.locks
        if self._is_command:
            # Locked before other processes can see the owner, so that none takes it for dead.
            self._lock = self._commands.hold(self.owner_id)
            self._work_lock = locks.hold(LongWork.command(self.owner_id))
        elif not self._exclusive:
            self._work_lock = locks.hold(LongWork.server(self.owner_id))
        with self._database.write() as transaction:
            refuse_other_schema(transaction.session)
            transaction.workers.register(self.owner_id)
            transaction.idempotency.clean(unfinished=self._exclusive)
        self.take_over()

    def beat(self, slots: Sequence[SlotState]) -> None:
        """Writes the heartbeat and the state of the slots; takes over runs of dead owners.

        Raises:
            StoreError: The database cannot be used.
        """
        with self._database.write() as transaction:
            transaction.workers.beat(self.owner_id, slots)
        self.take_over()

    def leave(self, in_flight: Sequence[str]) -> None:
        """Ends this process as an owner: its leases are released, runs of a command cancelled.

        Raises:
            StoreError: The database cannot be used.
        """
        with self._database.write() as transaction:
            transaction.queue.release(self.owner_id, in_flight)
            transaction.minimizations.interrupt(self.owner_id)
            transaction.batches.cancel_reserved(self.owner_id)
            transaction.workers.leave(self.owner_id)
        if self._work_lock is not None:
            self._work_lock.release()
        if self._lock is not None:
            self._lock.release()
            self._commands.forget(self.owner_id)

    def take_over(self) -> None:
        """Takes over the runs of dead owners; with each heartbeat.

        Raises:
            StoreError: The database cannot be used.
        """
        self._database.locks.keep()
        with self._database.read() as transaction:
            heartbeats = transaction.workers.heartbeats(me=self.owner_id)
        for owner_id in self._dead(heartbeats):
            _take_over_from(owner_id, self._database, self._policy, self._commands)
            self._seen.pop(owner_id, None)

    def _dead(self, heartbeats: dict[str, datetime]) -> list[str]:
        dead = self._commands.dead(heartbeats)
        # Servers, and commands with other data folders.
        others = [owner for owner in heartbeats if not self._commands.is_command(owner)]
        if self._is_command:
            return dead
        if self._exclusive:
            locks = self._database.locks
            return dead + [one for one in others if not locks.is_held(LongWork.command(one))]
        now = self._clock()
        if now - self._looked_at > _LONGEST_PAUSE_S:
            self._seen.clear()
        self._looked_at = now
        for owner_id in others:
            seen, heartbeat = self._seen.get(owner_id), heartbeats[owner_id]
            if seen is None or seen.heartbeat != heartbeat:
                self._seen[owner_id] = _Heartbeat(heartbeat=heartbeat, at=now)
        return dead + [one for one in others if self._is_dead(one, now - self._seen[one].at)]

    def _is_dead(self, owner_id: str, silent_s: float) -> bool:
        if silent_s >= HEARTBEAT_TIMEOUT_S:
            return True
        works = LongWork.server(owner_id), LongWork.command(owner_id)
        return silent_s >= LOCK_TIMEOUT_S and not any(map(self._database.locks.is_held, works))


def cancel_runs_of_dead_commands(
    database: Database, policy: RetryPolicy, commands: CommandLocks
) -> None:
    """Cancels the runs of commands that were killed; for processes that are no owners themselves.

    Raises:
        StoreError: The database cannot be used.
    """
    with database.read() as transaction:
        heartbeats = transaction.workers.heartbeats(me="")
    for owner_id in commands.dead(heartbeats):
        _take_over_from(owner_id, database, policy, commands)


def _take_over_from(
    owner_id: str, database: Database, policy: RetryPolicy, commands: CommandLocks
) -> None:
    with database.write() as transaction:
        runs = transaction.queue.reclaim(owner_id, policy)
        transaction.minimizations.interrupt(owner_id)
        transaction.batches.cancel_reserved(owner_id)
        transaction.workers.leave(owner_id)
    commands.forget(owner_id)
    database.locks.forget(LongWork.command(owner_id))
    _log.warning("took_over_from_dead_process", owner=owner_id, runs=runs)
