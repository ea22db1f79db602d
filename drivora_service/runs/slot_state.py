"""What a worker slot does."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class SlotState:
    """A worker slot at one moment.

    Attributes:
        name: Unique among the slots of one server.
        pid: Process id of its worker, ``None`` while there is none.
        run_id: What it runs, or "".
        phase: What the worker is doing, as in ``RunPhase``, in lower case.
        step: Row of the trace at which the run is.
        memory_bytes: Resident memory of the worker process.
        runs: Runs that the slot has ended.
        restarts: Worker processes it has had, beyond the first.
        last_crash: How its last worker to die unasked died, or "".
        updated_at: The moment, UTC.
    """

    name: str
    pid: int | None
    run_id: str
    phase: str
    step: int
    memory_bytes: int
    runs: int
    restarts: int
    last_crash: str
    updated_at: datetime
