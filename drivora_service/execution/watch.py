"""The limits of a run, checked from outside while it goes on."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.execution.executor import Limits
from drivora_service.runs.progress import Progress
from drivora_service.runs.report import RunFailure, RunStatus
from drivora_service.simulation.phase import Phase


@dataclass(frozen=True, slots=True, kw_only=True)
class Breach:
    """A limit that a run has broken; its worker is to be killed."""

    status: RunStatus
    failure: RunFailure


class Watch:
    """Watches one run.

    A run that is too long is timed out. An agent that stays in one call for too long has failed.
    Memory is laid to the agent if it was seen growing past the limit within a call of it, and to
    the simulator otherwise.
    """

    def __init__(self, limits: Limits, *, now: float) -> None:
        """Begins at ``now``, in seconds of a monotonic clock."""
        self._limits = limits
        self._begun = now
        self._seen: Progress | None = None
        self._seen_since = now

    def check(self, progress: Progress, memory_bytes: int, *, now: float) -> Breach | None:
        """Looks at a reading taken ``now``; gives the first limit that is broken."""
        if progress != self._seen:
            self._seen, self._seen_since = progress, now
        in_agent = progress.phase is Phase.IN_AGENT
        if memory_bytes > self._limits.memory_bytes:
            return self._memory_breach(progress, memory_bytes)
        if in_agent and now - self._seen_since > self._limits.agent_deadline_s:
            return Breach(
                status=RunStatus.AGENT_FAILED,
                failure=RunFailure(
                    cause="agent_hung",
                    message=f"the agent of ego number {progress.ego} did not return from "
                    f"{progress.call} within {self._limits.agent_deadline_s:g} s",
                ),
            )
        if now - self._begun > self._limits.wall_time_s:
            return Breach(
                status=RunStatus.TIMED_OUT,
                failure=RunFailure(
                    cause="wall_time_limit",
                    message=f"the run did not end within {self._limits.wall_time_s:g} s; it was "
                    f"{_where(progress)}",
                ),
            )
        return None

    def _memory_breach(self, progress: Progress, memory_bytes: int) -> Breach:
        in_agent = progress.phase is Phase.IN_AGENT
        return Breach(
            status=RunStatus.AGENT_FAILED if in_agent else RunStatus.SIMULATOR_CRASHED,
            failure=RunFailure(
                cause="memory_limit",
                message=f"the worker grew to {memory_bytes >> 20} MiB, beyond the limit of "
                f"{self._limits.memory_bytes >> 20} MiB; it was {_where(progress)}",
            ),
        )


def _where(progress: Progress) -> str:
    match progress.phase:
        case Phase.IN_AGENT:
            return f"in the agent of ego number {progress.ego} at {progress.call}"
        case Phase.SIMULATING:
            return f"simulating step {progress.step}"
        case phase:
            return phase.name.lower()
