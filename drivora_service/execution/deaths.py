"""What the death of a worker process says about the run that it had."""

from __future__ import annotations

import signal

from drivora_service.runs.report import RunFailure, RunReport, RunStatus
from drivora_service.simulation.phase import RunPhase
from drivora_service.worker.progress import Progress

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
"""Signals by which a program's own fault ends it; others come from outside."""


def signal_name(exit_code: int) -> str:
    """Names the signal of a negative exit code, "" for any other."""
    if exit_code >= 0:
        return ""
    try:
        return signal.Signals(-exit_code).name
    except ValueError:
        return f"signal {-exit_code}"


def report_death(run_id: str, exit_code: int, progress: Progress, log: str) -> RunReport:
    """Makes the report of a run whose worker died unasked.

    A fault, or an exit, within a call of an agent is the agent's; elsewhere it is the simulator's.
    A signal from outside, such as the kernel's when memory is short, is nobody's.
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
    """Makes the report of a run whose worker sent something that no worker sends.

    Args:
        run_id: The run.
        what: What was found.
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


def report_loss(run_id: str, message: str, log: str) -> RunReport:
    """Makes the report of a run whose worker was lost through nobody's fault."""
    return RunReport(
        run_id=run_id,
        status=RunStatus.INFRASTRUCTURE_FAILED,
        failure=RunFailure(cause="worker_lost", message=message, log=log),
    )
