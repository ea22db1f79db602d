"""The present state of the workers and of the queue."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING

from drivora_service.api.schemas.workers import Death, Fault, SlotActivity, Workers, WorkerSlot
from drivora_service.runs.slot_state import SlotState
from drivora_service.store.runs.run_records import OwnerRecord

if TYPE_CHECKING:
    from drivora_service.api.context import ApiContext
    from drivora_service.store.database import Transaction


def workers_now(context: ApiContext, transaction: Transaction) -> Workers:
    """Returns what the workers do.

    Slots of this process are as they are now, those of others as of their last heartbeat.
    """
    now = datetime.now(UTC)
    owners = sorted(
        transaction.workers.living_owners(),
        key=lambda owner: (owner.id != context.owner_id, owner.id),
    )
    return Workers(
        slots=tuple(slot for owner in owners for slot in _slots(context, owner)),
        queue=transaction.workers.loads(),
        ended_last_minute=transaction.workers.count_ended_since(now - timedelta(minutes=1)),
        ended_last_hour=transaction.workers.count_ended_since(now - timedelta(hours=1)),
        faults=tuple(
            Fault(name=name, detail=detail) for name, detail in context.faults().items() if detail
        ),
    )


def _slots(context: ApiContext, owner: OwnerRecord) -> Iterable[WorkerSlot]:
    is_own = owner.id == context.owner_id
    for slot in context.own_slots() if is_own else owner.slots:
        yield WorkerSlot(
            name=slot.name,
            process=owner.id,
            is_own=is_own,
            host=owner.host,
            pid=slot.pid,
            state=_activity(slot),
            phase=slot.phase,
            run_id=slot.run_id,
            since=slot.since,
            step=slot.step,
            memory_bytes=slot.memory_bytes,
            runs=slot.runs,
            recycled=slot.restarts,
            last_death=(
                Death(at=slot.last_crash_at, cause=slot.last_crash) if slot.last_crash else None
            ),
            updated_at=slot.updated_at,
        )


def _activity(slot: SlotState) -> SlotActivity:
    if slot.run_id:
        return SlotActivity.RUNNING
    return SlotActivity.STARTING if slot.phase == "starting" else SlotActivity.IDLE
