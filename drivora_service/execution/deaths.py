"""Reports of runs whose worker process died."""

from __future__ import annotations

import signal

from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.simulation.run_phase import RunPhase
from drivora_service.worker.progress_board import Progress

_CRASHES = frozenset(
    {
        signal.SIGSEGV,
        signal.SIGABRT,
        signal.SIGBUS,
        signal.SIGFPE,
        signal.SIGILL,
        signal.SIGTRAP,
        signal.SIGSYS,
    }
)
"""Signals that a program's own fault raises; others come from outside."""

WORKER_LOST = "worker_lost"
"""Cause of an attempt whose worker was killed from outside."""


def signal_name(exit_code: int) -> str:
    """Returns the name of the signal of a negative exit code, "" for any other."""
    if exit_code >= 0:
        return ""
    try:
        return signal.Signals(-exit_code).name
    except ValueError:
        return f"signal {-exit_code}"


def report_death(run_id: str, exit_code: int, progress: Progress, log: str) -> RunReport:
    """Returns the report of a run whose worker died unexpectedly.

    A crash or exit within a call of an agent is attributed to the agent, elsewhere to the
    simulator, and a signal from outside, such as the kernel's when memory is short, to the
    infrastructure.
    """
    name = signal_name(exit_code)
    in_agent, place = progress.phase is RunPhase.IN_AGENT, _place(progress)
    if name and -exit_code not in _CRASHES:
        return report_loss(run_id, f"the worker was ended by {name} {place}", log)
    how = f"died of {name}" if name else f"exited with code {exit_code}"
    return RunReport(
        run_id=run_id,
        status=RunStatus.AGENT_FAILED if in_agent else RunStatus.SIMULATOR_CRASHED,
        failure=RunFailure(
            cause="signal" if name else "worker_exited",
            message=f"the worker {how} {place}",
            log=log,
        ),
    )


def report_breach(run_id: str, what: str, progress: Progress, log: str) -> RunReport:
    """Returns the report of a run whose worker broke the protocol.

    Args:
        run_id: The run.
        what: Description of what the worker sent.
        progress: Where the worker was.
        log: The last lines of its log.
    """
    in_agent = progress.phase is RunPhase.IN_AGENT
    return RunReport(
        run_id=run_id,
        status=RunStatus.AGENT_FAILED if in_agent else RunStatus.INFRASTRUCTURE_FAILED,
        failure=RunFailure(
            cause="worker_protocol",
            message=f"the worker broke the protocol {_place(progress)}: {what}",
            log=log,
        ),
    )


def _place(progress: Progress) -> str:
    if progress.phase is RunPhase.IN_AGENT:
        return f"in the agent of ego number {progress.ego} at {progress.call}"
    return f"while {progress.phase.name.lower()}, at step {progress.step}"


def report_loss(run_id: str, message: str, log: str, *, cause: str = WORKER_LOST) -> RunReport:
    """Returns the report of a run whose worker was lost to the infrastructure."""
    return RunReport(
        run_id=run_id,
        status=RunStatus.INFRASTRUCTURE_FAILED,
        failure=RunFailure(cause=cause, message=message, log=log),
    )
