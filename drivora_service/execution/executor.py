"""The executor protocol, the same for one machine and for many."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.run_report import RunSpec
from drivora_service.runs.slot_state import SlotState


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Limits of a worker.

    Attributes:
        wall_time_s: Seconds a run may take.
        agent_deadline_s: Seconds one call of an agent may take.
        memory_bytes: Resident memory a worker process and its descendants may have together.
        runs_per_worker: Runs after which a worker process is replaced, against leaks in code under
            test; the simulator has none worth mentioning, and a start costs seconds.
        start_s: Seconds a new worker process may take until it is ready; the first one of an
            installation compiles.
        log_bytes: Size of a worker's log beyond which only its end is kept.
    """

    wall_time_s: float = 600.0
    agent_deadline_s: float = 10.0
    memory_bytes: int = 2 << 30
    runs_per_worker: int = 2000
    start_s: float = 300.0
    log_bytes: int = 8 << 20


class Executor(Protocol):
    """Runs attempts on a number of slots.

    :meth:`wait` returns every submitted spec exactly once, whatever happens to its worker, unless
    it is withdrawn or the executor is closed before. Nothing is repeated here: the caller and
    ``runs.lifecycle`` decide whether another attempt follows.
    """

    @property
    def capacity(self) -> int:
        """Number of slots: attempts that can run at once; at least 1.

        It may change: machines join and leave.
        """
        ...

    @property
    def fault(self) -> str:
        """The reason that no worker can be started and what to do, "" without a fault.

        Specs wait meanwhile; none of them fails. :meth:`wait` returns when a fault is found.
        """
        ...

    def submit(self, spec: RunSpec) -> None:
        """Queues an attempt, which starts when a slot is free; first in, first out."""
        ...

    def cancel(self, run_id: str) -> None:
        """Ends an attempt; its status is ``cancelled``, or that of its end just before."""
        ...

    def withdraw(self) -> tuple[str, ...]:
        """Removes every spec that was not started; returns the ids of their runs.

        :meth:`wait` does not return them.
        """
        ...

    def wait(self, timeout: float | None = None, *, count: int = 1) -> tuple[AttemptEnd, ...]:
        """Returns the attempts that have ended since the last call.

        Waits until there are ``count``, until :meth:`wake` or for ``timeout`` seconds. Only one
        thread waits at a time.
        """
        ...

    def wake(self) -> None:
        """Makes the current or next :meth:`wait` return at once."""
        ...

    def slots(self) -> tuple[SlotState, ...]:
        """Returns the state of each slot."""
        ...

    def close(self) -> None:
        """Ends every attempt and every worker process; nothing is left behind."""
        ...
