"""Server processes that hold leases, and the states of their worker slots."""

from __future__ import annotations

import os
import socket
from collections import Counter
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import cast

from sqlalchemy import Table, delete, func, insert, select, update
from sqlalchemy.orm import Session

from drivora_service.runs.slot_state import SlotState
from drivora_service.shapes import field_names
from drivora_service.store.changes.revisions import begin_epoch
from drivora_service.store.engine.ids import new_id
from drivora_service.store.runs.run_records import BatchState, OwnerRecord, Priority, QueueLoad
from drivora_service.store.runs.run_tables import AttemptRow, BatchRow, OwnerRow, RunRow, SlotRow


class WorkerRepository:
    """Owners, their heartbeats and slots."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def register(self, owner_id: str = "") -> str:
        """Registers this process as an owner of leases and returns its id.

        Args:
            owner_id: Its id; "": one is made.
        """
        now = datetime.now(UTC)
        owner = OwnerRow(
            id=owner_id or new_id(),
            host=socket.gethostname(),
            pid=os.getpid(),
            started_at=now,
            heartbeat_at=now,
        )
        self._session.add(owner)
        self._session.flush()
        begin_epoch(self._session)
        return owner.id

    def beat(self, owner_id: str, slots: Sequence[SlotState]) -> None:
        """Writes the heartbeat of an owner and the states of its slots."""
        # An owner that was taken for dead but lives gets new leases from now on.
        self._session.execute(
            update(OwnerRow)
            .where(OwnerRow.id == owner_id)
            .values(heartbeat_at=datetime.now(UTC), ended_at=None)
        )
        self._session.execute(delete(SlotRow).where(SlotRow.owner_id == owner_id))
        if not slots:
            return
        names = field_names(SlotState)
        rows = [
            {"owner_id": owner_id} | {name: getattr(slot, name) for name in names} for slot in slots
        ]
        # One statement for all slots; the table, as the ORM would follow each row.
        self._session.execute(insert(cast("Table", SlotRow.__table__)), rows)

    def leave(self, owner_id: str) -> None:
        """Removes an owner without leases."""
        self._session.execute(
            update(OwnerRow).where(OwnerRow.id == owner_id).values(ended_at=datetime.now(UTC))
        )
        self._session.execute(delete(SlotRow).where(SlotRow.owner_id == owner_id))

    def heartbeats(self, *, me: str) -> dict[str, datetime]:
        """Returns the last heartbeats of the owners other than ``me`` that have not left.

        They are times of the owners' own clocks: changes can be seen, ages cannot.
        """
        query = select(OwnerRow.id, OwnerRow.heartbeat_at).where(
            OwnerRow.id != me, OwnerRow.ended_at.is_(None)
        )
        return {row.id: row.heartbeat_at for row in self._session.execute(query)}

    def loads(self) -> tuple[QueueLoad, ...]:
        """Returns how many runs wait and run, by priority."""
        waiting = select(BatchRow.priority, BatchRow.state, func.sum(BatchRow.queued))
        queued: Counter[int] = Counter()
        paused: Counter[int] = Counter()
        for rank, state, number in self._session.execute(
            waiting.where(BatchRow.queued > 0).group_by(BatchRow.priority, BatchRow.state)
        ):
            (queued if state == BatchState.OPEN else paused)[rank] += number
        leased = (
            select(BatchRow.priority, func.count())
            .select_from(AttemptRow)
            .join(RunRow, RunRow.seq == AttemptRow.run_seq)
            .join(BatchRow, BatchRow.seq == RunRow.batch_seq)
            .where(AttemptRow.ended_at.is_(None))
            .group_by(BatchRow.priority)
        )
        running = {row[0]: row[1] for row in self._session.execute(leased)}
        return tuple(
            QueueLoad(
                priority=priority,
                queued=queued[priority.rank],
                paused=paused[priority.rank],
                running=running.get(priority.rank, 0),
            )
            for priority in Priority
        )

    def count_ended_since(self, moment: datetime) -> int:
        """Returns the number of runs that have ended since a moment."""
        query = select(func.count()).select_from(RunRow).where(RunRow.ended_at >= moment)
        return self._session.scalar(query.where(RunRow.ended_at.is_not(None))) or 0

    def living_owners(self) -> tuple[OwnerRecord, ...]:
        """Returns the owners that have not left, with their slots."""
        owners = self._session.scalars(
            select(OwnerRow).where(OwnerRow.ended_at.is_(None)).order_by(OwnerRow.started_at)
        ).all()
        slots = self._session.scalars(select(SlotRow).order_by(SlotRow.name)).all()
        return tuple(
            OwnerRecord(
                id=owner.id,
                host=owner.host,
                pid=owner.pid,
                started_at=owner.started_at,
                heartbeat_at=owner.heartbeat_at,
                slots=tuple(_slot(slot) for slot in slots if slot.owner_id == owner.id),
            )
            for owner in owners
        )


def _slot(row: SlotRow) -> SlotState:
    return SlotState(
        name=row.name,
        pid=row.pid,
        run_id=row.run_id,
        phase=row.phase,
        step=row.step,
        memory_bytes=row.memory_bytes,
        runs=row.runs,
        restarts=row.restarts,
        last_crash=row.last_crash,
        updated_at=row.updated_at,
        since=row.since,
        last_crash_at=row.last_crash_at,
    )
