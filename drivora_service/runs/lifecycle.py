"""The life cycle of a run: a pure state machine.

::

    queued ──start──▶ running ──end──▶ finished, invalid, agent_failed, plugin_failed, timed_out
      ▲                 │              (final)
      │                 ├── simulator_crashed: repeated once; the second crash is final and
      │                 │   quarantines the scenario; an error that SUMO reported is final
      ├─── again ◀──────┤
      │                 ├── infrastructure_failed: again, up to a limit (not_begun: always)
      │                 └── interrupted (the server died): again, up to a limit
      └──cancel──▶ cancelled

Pure functions from state to state. The owner of the state (the store, or a list in memory) applies
them and acts on the :class:`Transition`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus

LONGEST_WAIT_S = 600.0
"""Seconds that a run waits at most after a death of the server; see :class:`RetryPolicy`."""

SIMULATOR_ERROR = "simulator_error"
"""Cause of a run in which SUMO refused a call that should have worked."""

NOT_BEGUN = "not_begun"
"""Cause of an attempt that was lost before a worker is known to have begun it; it costs nothing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RetryPolicy:
    """The numbers of attempts that a run may lose for reasons that are not its own.

    Attributes:
        infrastructure_failures: Attempts that may be lost before the run fails.
        crashes: Crashes of the simulator that confirm each other.
        interruptions: Deaths of the server that a run survives; the limit ends the loop of a run
            that takes the whole machine down.
        trusted_interruptions: Deaths of the server after which a run waits, and is run after all
            others.
        first_wait_s: Seconds of the first wait; doubled with each death after it.
        longest_wait_s: Seconds of the longest wait.
    """

    infrastructure_failures: int = 3
    crashes: int = 2
    interruptions: int = 20
    trusted_interruptions: int = 3
    first_wait_s: float = 30.0
    longest_wait_s: float = LONGEST_WAIT_S


@dataclass(frozen=True, slots=True, kw_only=True)
class RunState:
    """The state of a run on which its next transition depends."""

    status: RunStatus = RunStatus.QUEUED
    infrastructure_failures: int = 0
    crashes: int = 0
    interruptions: int = 0
    cancel_requested: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Transition:
    """The result of an event.

    Attributes:
        state: The new state.
        report: The end of the run, or ``None`` while it goes on.
        quarantine: Whether the scenario is confirmed to crash the simulator and must not run again.
        wait_s: Seconds before the run may be started again; then it is last in the queue.
    """

    state: RunState
    report: RunReport | None = None
    quarantine: bool = False
    wait_s: float = 0.0


def start(state: RunState) -> RunState:
    """Returns the state of a run that a worker has taken.

    Raises:
        ValueError: The run is not queued.
    """
    _expect(state, RunStatus.QUEUED)
    return _with_status(state, RunStatus.RUNNING)


def end(state: RunState, report: RunReport, policy: RetryPolicy) -> Transition:
    """Returns the transition at the end of an attempt with ``report``.

    Raises:
        ValueError: The run is not running, or the report is not final.
    """
    _expect(state, RunStatus.RUNNING)
    match report.status:
        case RunStatus.QUEUED | RunStatus.RUNNING:
            raise ValueError(f"{report.status} is not the end of an attempt")
        case RunStatus.SIMULATOR_CRASHED:
            state = replace(state, crashes=state.crashes + 1)
            if report.failure is not None and report.failure.cause == SIMULATOR_ERROR:
                # An exception, not a crash: it is repeatable and harms no worker.
                return Transition(state=_final(state, report), report=report)
            if state.crashes >= policy.crashes:
                return Transition(state=_final(state, report), report=report, quarantine=True)
            return _again(state, report.run_id)
        case RunStatus.INFRASTRUCTURE_FAILED:
            if report.failure is not None and report.failure.cause == NOT_BEGUN:
                return _again(state, report.run_id)
            state = replace(state, infrastructure_failures=state.infrastructure_failures + 1)
            if state.infrastructure_failures >= policy.infrastructure_failures:
                return Transition(state=_final(state, report), report=report)
            return _again(state, report.run_id)
        case _:
            return Transition(state=_final(state, report), report=report)


def interrupt(state: RunState, run_id: str, policy: RetryPolicy) -> Transition:
    """Returns the transition after the death of the process that supervised the run.

    Raises:
        ValueError: The run is not running.
    """
    _expect(state, RunStatus.RUNNING)
    state = replace(state, interruptions=state.interruptions + 1)
    if state.interruptions < policy.interruptions:
        return replace(_again(state, run_id), wait_s=_wait_s(state.interruptions, policy))
    report = RunReport(
        run_id=run_id,
        status=RunStatus.INFRASTRUCTURE_FAILED,
        failure=RunFailure(
            cause="interrupted",
            message=f"the server died {state.interruptions} times while this run was running",
        ),
    )
    return Transition(state=_final(state, report), report=report)


def release(state: RunState, run_id: str) -> Transition:
    """Returns the transition of a run that a stopping server puts back, unchanged.

    Raises:
        ValueError: The run is not running.
    """
    _expect(state, RunStatus.RUNNING)
    return _again(state, run_id)


def cancel(state: RunState, run_id: str) -> Transition:
    """Returns the transition after a request to cancel the run.

    A queued run ends at once. A running one ends when its worker has been stopped; if it ends by
    itself before, that end counts. A final one is unchanged.
    """
    if state.status is RunStatus.RUNNING:
        return Transition(state=replace(state, cancel_requested=True))
    if state.status.is_final:
        return Transition(state=state)
    report = cancelled_report(run_id)
    return Transition(state=_final(state, report), report=report)


def cancelled_report(run_id: str) -> RunReport:
    """Returns the report of a cancelled run."""
    return RunReport(
        run_id=run_id,
        status=RunStatus.CANCELLED,
        failure=RunFailure(cause="cancelled", message="the run was cancelled"),
    )


def _again(state: RunState, run_id: str) -> Transition:
    if state.cancel_requested:
        report = cancelled_report(run_id)
        return Transition(state=_final(state, report), report=report)
    return Transition(state=_with_status(state, RunStatus.QUEUED))


def _wait_s(interruptions: int, policy: RetryPolicy) -> float:
    beyond = interruptions - policy.trusted_interruptions
    if beyond < 0:
        return 0.0
    return float(min(policy.first_wait_s * 2.0**beyond, policy.longest_wait_s))


def _final(state: RunState, report: RunReport) -> RunState:
    return _with_status(state, report.status)


@lru_cache(maxsize=512)
def _with_status(state: RunState, status: RunStatus) -> RunState:
    """Returns a state with another status; most runs have one of few states."""
    return replace(state, status=status)


def _expect(state: RunState, status: RunStatus) -> None:
    if state.status is not status:
        raise ValueError(f"the run is {state.status}, not {status}")
