"""What the workers do, and what waits for them."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from drivora_service.shapes import Shape
from drivora_service.store.runs.run_records import QueueLoad


class SlotActivity(StrEnum):
    """What a slot does."""

    STARTING = "starting"
    """Its worker is not ready yet."""
    IDLE = "idle"
    RUNNING = "running"


@dataclass(frozen=True, slots=True, kw_only=True)
class Death(Shape):
    """The unexpected end of a worker.

    Attributes:
        at: null if it was not recorded.
        cause: What is known of it.
    """

    at: datetime | None
    cause: str


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerSlot(Shape):
    """A slot: one worker process at a time, and its successors.

    Attributes:
        name: Unique among the slots of a process.
        process: Id of the process that has the slot: this service, or a command with runs of its
            own in the same data folder.
        is_own: Whether this service has it.
        host: Machine of that process.
        pid: Process id of the worker; null while there is none.
        phase: What the worker does in detail, such as the part of a step.
        run_id: Its run; empty without one.
        since: When it began that, by the clock of its process; null if it was not recorded.
        step: Row of the trace that its run has reached.
        memory_bytes: Resident memory of the worker.
        runs: Runs that the slot has ended.
        recycled: Worker processes that came after its first one.
        last_death: Unexpected end of its last worker that died; null if none did.
        updated_at: Time of this state.
    """

    name: str
    process: str
    is_own: bool
    host: str
    pid: int | None
    state: SlotActivity
    phase: str
    run_id: str
    since: datetime | None
    step: int
    memory_bytes: int
    runs: int
    recycled: int
    last_death: Death | None
    updated_at: datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault(Shape):
    """Why nothing is run now, or nothing is taken.

    Attributes:
        name: Condition of `/readyz` that is not met.
        detail: What was found, and what to do.
    """

    name: str
    detail: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Workers(Shape):
    """What the workers do, and what waits for them.

    Attributes:
        slots: Those of this service first.
        queue: Runs that have not ended by priority, the most urgent first.
        ended_last_minute: Runs that have ended in the last minute, in whatever way.
        ended_last_hour: The same of the last hour.
        faults: Empty where runs are taken and run.
    """

    slots: tuple[WorkerSlot, ...]
    queue: tuple[QueueLoad, ...]
    ended_last_minute: int
    ended_last_hour: int
    faults: tuple[Fault, ...]
