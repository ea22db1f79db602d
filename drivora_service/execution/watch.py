"""The limits of a run, checked from outside while it runs.

The time that counts against an agent is the worker's own, see ``own_time``.
"""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.execution.executor import Limits
from drivora_service.execution.own_time import OwnTime
from drivora_service.runs.run_report import RunFailure, RunStatus
from drivora_service.simulation.run_phase import RunPhase
from drivora_service.worker.process_readings import ProcessReading
from drivora_service.worker.progress_board import Progress

_OWN_SHARE = 0.5
"""Share of its wall time that a run must have had itself to count as timed out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """A sample of a worker in a run.

    Attributes:
        progress: Progress that it shows.
        process: The system's data on it, ``None`` if unknown.
        descendant_memory: Bytes of memory of the processes started in it.
        now: Seconds of a monotonic clock.
    """

    progress: Progress
    process: ProcessReading | None
    descendant_memory: int = 0
    now: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Breach:
    """A limit that a run has exceeded; its worker must be killed."""

    status: RunStatus
    failure: RunFailure


class Watch:
    """The limits of one run, with the time and memory that it has used.

    A run that is too long is timed out, or was stopped if it had little of that time itself. An
    agent whose call takes too long has failed. Memory is attributed to the agent if the worker was
    beyond the limit during a call of the agent, or through processes that it started, and to the
    simulator otherwise.
    """

    def __init__(self, limits: Limits, *, now: float) -> None:
        """Creates the watch of a run that begins at ``now``, in seconds of a monotonic clock."""
        self._limits = limits
        self._time = OwnTime(now=now)
        self._passed = self._own = 0.0
        self._seen: Progress | None = None
        self._in_call = 0.0

    def check(self, sample: Sample) -> Breach | None:
        """Accounts for a sample; returns the first limit that is exceeded."""
        own = self._account(sample)
        if sample.progress != self._seen:
            self._seen, self._in_call = sample.progress, 0.0
        else:
            self._in_call += own
        in_agent = sample.progress.phase is RunPhase.IN_AGENT
        resident = 0 if sample.process is None else sample.process.memory_bytes
        if resident + sample.descendant_memory > self._limits.memory_bytes:
            return self._memory_breach(sample, resident)
        if in_agent and self._in_call > self._limits.agent_deadline_s:
            return Breach(
                status=RunStatus.AGENT_FAILED,
                failure=RunFailure(
                    cause="agent_hung",
                    message=f"the agent of ego number {sample.progress.ego} did not return from "
                    f"{sample.progress.call} within {self._limits.agent_deadline_s:g} s",
                ),
            )
        if self._passed > self._limits.wall_time_s:
            return self._time_breach(sample.progress)
        return None

    def _account(self, sample: Sample) -> float:
        """Returns the seconds of the worker's own time since the last sample."""
        passed, own = self._time.add(sample.process, sample.now)
        self._passed += passed
        self._own += own
        return own

    def _time_breach(self, progress: Progress) -> Breach:
        limit = self._limits.wall_time_s
        if self._own < _OWN_SHARE * limit:
            return Breach(
                status=RunStatus.INFRASTRUCTURE_FAILED,
                failure=RunFailure(
                    cause="worker_stopped",
                    message=f"the worker was stopped or held up: of {limit:g} s it had "
                    f"{self._own:.3g} s itself; it was {_where(progress)}",
                ),
            )
        return Breach(
            status=RunStatus.TIMED_OUT,
            failure=RunFailure(
                cause="wall_time_limit",
                message=f"the run did not end within {limit:g} s; it was {_where(progress)}",
            ),
        )

    def _memory_breach(self, sample: Sample, resident: int) -> Breach:
        limit = self._limits.memory_bytes
        started = resident <= limit
        by_agent = started or sample.progress.phase is RunPhase.IN_AGENT
        grown = (
            f"the worker grew to {resident >> 20} MiB and the processes that were started in it to "
            f"{sample.descendant_memory >> 20} MiB"
            if sample.descendant_memory
            else f"the worker grew to {resident >> 20} MiB"
        )
        return Breach(
            status=RunStatus.AGENT_FAILED if by_agent else RunStatus.SIMULATOR_CRASHED,
            failure=RunFailure(
                cause="memory_limit",
                message=f"{grown}, beyond the limit of {limit >> 20} MiB; "
                f"it was {_where(sample.progress)}",
            ),
        )


def _where(progress: Progress) -> str:
    match progress.phase:
        case RunPhase.IN_AGENT:
            return f"in the agent of ego number {progress.ego} at {progress.call}"
        case RunPhase.SIMULATING:
            return f"simulating step {progress.step}"
        case phase:
            return phase.name.lower()
