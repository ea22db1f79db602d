"""The server as the owner of leases: its heartbeat, and the leases of servers that died."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime

import structlog

from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.runs.slot_state import SlotState
from drivora_service.store.database import Database

SILENCE_S = 30.0
"""Seconds without a heartbeat after which another server's runs are taken over."""

_log = structlog.get_logger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Seen:
    """A heartbeat of another server, and when it was new, by the clock of this process."""

    heartbeat: datetime
    at: float


class Ownership:
    """This process as an owner of leases.

    Whether another server lives is judged by its heartbeats changing, in seconds of this process's
    own clock. The times that stand in the database are of clocks that may jump.
    """

    def __init__(
        self,
        database: Database,
        policy: RetryPolicy,
        *,
        exclusive: bool,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Prepares; :meth:`register` makes this process an owner.

        Args:
            database: Where leases are kept.
            policy: What becomes of runs that are taken over.
            exclusive: Whether every other owner is dead for sure.
            clock: Returns seconds that never go backwards.
        """
        self._database, self._policy = database, policy
        self._exclusive, self._clock = exclusive, clock
        self._seen: dict[str, _Seen] = {}
        self.owner_id = ""

    def register(self) -> None:
        """Makes this process an owner and takes over what servers known to be dead left behind.

        Raises:
            StoreError: The database cannot be used.
        """
        with self._database.write() as transaction:
            self.owner_id = transaction.workers.register()
            transaction.idempotency.clean(unfinished=self._exclusive)
        self._take_over()

    def beat(self, slots: Sequence[SlotState]) -> None:
        """Says that this process lives and what its slots do; takes over from the dead.

        Raises:
            StoreError: The database cannot be used.
        """
        with self._database.write() as transaction:
            transaction.workers.beat(self.owner_id, slots)
        if not self._exclusive:
            self._take_over()

    def _take_over(self) -> None:
        with self._database.read() as transaction:
            heartbeats = transaction.workers.heartbeats(me=self.owner_id)
        for owner_id in self._dead(heartbeats):
            with self._database.write() as transaction:
                runs = transaction.queue.reclaim(owner_id, self._policy)
                transaction.workers.leave(owner_id)
            self._seen.pop(owner_id, None)
            _log.warning("took_over_from_dead_server", owner=owner_id, runs=runs)

    def _dead(self, heartbeats: dict[str, datetime]) -> list[str]:
        if self._exclusive:
            return list(heartbeats)
        now = self._clock()
        for owner_id, heartbeat in heartbeats.items():
            seen = self._seen.get(owner_id)
            if seen is None or seen.heartbeat != heartbeat:
                self._seen[owner_id] = _Seen(heartbeat=heartbeat, at=now)
        return [owner for owner in heartbeats if now - self._seen[owner].at >= SILENCE_S]
