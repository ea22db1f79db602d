"""The state of a worker slot."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class SlotState:
    """A worker slot at one moment.

    Attributes:
        name: Unique among the slots of one server.
        pid: Process id of its worker, ``None`` while there is none.
        run_id: Id of its run, or "".
        phase: Phase of the worker, as in ``RunPhase``, in lower case.
        step: Current row of the trace.
        memory_bytes: Resident memory of the worker process.
        runs: Runs that the slot has ended.
        restarts: Number of its worker processes after the first.
        last_crash: How its last worker died unexpectedly, or "".
        updated_at: Time of this state, UTC.
        since: When it began what it does: to start a worker, to wait, or its run.
        last_crash_at: When its last worker died unexpectedly, ``None`` if none did.
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
    since: datetime | None = None
    last_crash_at: datetime | None = None
