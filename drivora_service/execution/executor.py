"""What runs runs: a protocol, so that one machine and many look the same."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.report import RunSpec
from drivora_service.runs.slot_state import SlotState


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """What a worker may use.

    Attributes:
        wall_time_s: Seconds a run may take.
        agent_deadline_s: Seconds one call of an agent may take.
        memory_bytes: Resident memory a worker process may have, with all that was started in it.
        runs_per_worker: Runs after which a worker process is replaced, against leaks in code under
            test; the simulator has none worth mentioning, and a start costs seconds.
        start_s: Seconds a new worker process may take until it is ready; the first one of an
            installation compiles.
        log_bytes: Size beyond which all but the end of a worker's log is dropped.
    """

    wall_time_s: float = 600.0
    agent_deadline_s: float = 10.0
    memory_bytes: int = 2 << 30
    runs_per_worker: int = 2000
    start_s: float = 300.0
    log_bytes: int = 8 << 20


class Executor(Protocol):
    """Runs attempts on a number of slots.

    Every submitted spec comes back exactly once from :meth:`wait`, whatever happens to its worker,
    unless it is withdrawn or the executor is closed before. Nothing is repeated here: whether
    another attempt follows is for the caller and ``runs.lifecycle`` to say.
    """

    @property
    def capacity(self) -> int:
        """Slots: attempts that can go on at once."""
        ...

    @property
    def fault(self) -> str:
        """Why no worker can be started and what to do, "" if one can or has not been tried.

        Specs wait meanwhile; none of them fails. :meth:`wait` returns when a fault is found.
        """
        ...

    def submit(self, spec: RunSpec) -> None:
        """Starts an attempt as soon as a slot is free; specs wait in the order of their coming."""
        ...

    def cancel(self, run_id: str) -> None:
        """Ends an attempt; it comes back as ``cancelled``, or as it ended just before."""
        ...

    def withdraw(self) -> tuple[str, ...]:
        """Takes back every spec that was not begun; returns the ids of their runs.

        They do not come from :meth:`wait`.
        """
        ...

    def wait(self, timeout: float | None = None) -> tuple[AttemptEnd, ...]:
        """Returns the attempts that have ended since the last call.

        Waits for one if there is none, until :meth:`wake` or for ``timeout`` seconds.
        """
        ...

    def wake(self) -> None:
        """Makes a :meth:`wait` that is going on, or the next one, return at once."""
        ...

    def slots(self) -> tuple[SlotState, ...]:
        """Tells what each slot does."""
        ...

    def close(self) -> None:
        """Ends every attempt and every worker process; nothing is left behind."""
        ...
