from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from drivora_service.runs import lifecycle
from drivora_service.runs.lifecycle import RetryPolicy, RunState, Transition
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus

OWN_ENDS = (
    RunStatus.FINISHED,
    RunStatus.INVALID,
    RunStatus.AGENT_FAILED,
    RunStatus.PLUGIN_FAILED,
    RunStatus.TIMED_OUT,
    RunStatus.CANCELLED,
)


def report(status: RunStatus) -> RunReport:
    return RunReport(run_id="run", status=status)


def running(**counts: int) -> RunState:
    return RunState(status=RunStatus.RUNNING, **counts)  # type: ignore[arg-type] # counts only


@pytest.mark.parametrize("status", OWN_ENDS)
def test_what_a_run_ends_with_by_itself_is_final(status: RunStatus) -> None:
    transition = lifecycle.end(running(), report(status), RetryPolicy())
    assert transition.state.status is status
    assert transition.report == report(status)
    assert not transition.quarantine


def test_a_crash_is_confirmed_before_it_counts() -> None:
    crash = report(RunStatus.SIMULATOR_CRASHED)
    first = lifecycle.end(running(), crash, RetryPolicy())
    assert (first.state.status, first.report, first.quarantine) == (RunStatus.QUEUED, None, False)
    second = lifecycle.end(lifecycle.start(first.state), crash, RetryPolicy())
    assert (second.state.status, second.report, second.quarantine) == (crash.status, crash, True)


def test_an_error_that_sumo_reports_is_final_at_once() -> None:
    failure = RunFailure(cause=lifecycle.SIMULATOR_ERROR, message="SUMO refused a call")
    error = replace(report(RunStatus.SIMULATOR_CRASHED), failure=failure)
    first = lifecycle.end(running(), error, RetryPolicy())
    assert (first.state.status, first.report, first.quarantine) == (error.status, error, False)


def test_attempts_that_were_not_begun_cost_nothing() -> None:
    failure = RunFailure(cause=lifecycle.NOT_BEGUN, message="the node was lost")
    lost = replace(report(RunStatus.INFRASTRUCTURE_FAILED), failure=failure)
    state = running()
    for _ in range(10):
        transition = lifecycle.end(state, lost, RetryPolicy())
        assert (transition.state, transition.report) == (RunState(), None)
        state = lifecycle.start(transition.state)
    cancelled = lifecycle.end(replace(state, cancel_requested=True), lost, RetryPolicy())
    assert cancelled.state.status is RunStatus.CANCELLED


def test_a_crash_that_is_not_repeated_does_not_quarantine() -> None:
    crash, finish = report(RunStatus.SIMULATOR_CRASHED), report(RunStatus.FINISHED)
    first = lifecycle.end(running(), crash, RetryPolicy())
    second = lifecycle.end(lifecycle.start(first.state), finish, RetryPolicy())
    assert (second.report, second.quarantine) == (finish, False)


@pytest.mark.parametrize("status", [RunStatus.QUEUED, RunStatus.RUNNING])
def test_an_attempt_does_not_end_unfinished(status: RunStatus) -> None:
    with pytest.raises(ValueError, match="not the end"):
        lifecycle.end(running(), report(status), RetryPolicy())


class LifeOfARun(RuleBasedStateMachine):
    """Any order of events that can happen, checked against what must hold whatever happens."""

    @initialize(
        policy=st.builds(
            RetryPolicy,
            infrastructure_failures=st.integers(1, 3),
            crashes=st.integers(1, 3),
            interruptions=st.integers(1, 3),
        )
    )
    def begin(self, policy: RetryPolicy) -> None:
        self.policy = policy
        self.state = RunState()
        self.starts = 0
        self.releases = 0
        self.reports: list[RunReport] = []
        self.cancelled = False

    def follow(self, transition: Transition) -> None:
        self.state = transition.state
        if transition.report is not None:
            self.reports.append(transition.report)
        if transition.quarantine:
            assert transition.state.status is RunStatus.SIMULATOR_CRASHED
            assert transition.state.crashes == self.policy.crashes

    @precondition(lambda self: self.state.status is RunStatus.QUEUED)
    @rule()
    def start(self) -> None:
        assert not self.cancelled
        self.state = lifecycle.start(self.state)
        self.starts += 1

    @precondition(lambda self: self.state.status is RunStatus.RUNNING)
    @rule(
        status=st.sampled_from(
            [*OWN_ENDS, RunStatus.SIMULATOR_CRASHED, RunStatus.INFRASTRUCTURE_FAILED]
        )
    )
    def end(self, status: RunStatus) -> None:
        self.follow(lifecycle.end(self.state, report(status), self.policy))

    @precondition(lambda self: self.state.status is RunStatus.RUNNING)
    @rule()
    def interrupt(self) -> None:
        self.follow(lifecycle.interrupt(self.state, "run", self.policy))

    @precondition(lambda self: self.state.status is RunStatus.RUNNING)
    @rule()
    def release(self) -> None:
        self.releases += 1
        self.follow(lifecycle.release(self.state, "run"))

    @rule()
    def cancel(self) -> None:
        self.cancelled = True
        self.follow(lifecycle.cancel(self.state, "run"))

    @precondition(lambda self: self.state.status is not RunStatus.RUNNING)
    @rule()
    def nothing_ends_that_does_not_run(self) -> None:
        with pytest.raises(ValueError, match="not running"):
            lifecycle.end(self.state, report(RunStatus.FINISHED), self.policy)

    @precondition(lambda self: self.state.status is not RunStatus.QUEUED)
    @rule()
    def nothing_starts_that_does_not_wait(self) -> None:
        with pytest.raises(ValueError, match="not queued"):
            lifecycle.start(self.state)

    @invariant()
    def one_report_for_every_run_that_is_over_and_none_before(self) -> None:
        assert len(self.reports) == (1 if self.state.status.is_final else 0)
        if self.reports:
            assert self.reports[0].status is self.state.status

    @invariant()
    def a_cancelled_run_never_waits_again(self) -> None:
        assert not (self.cancelled and self.state.status is RunStatus.QUEUED)

    @invariant()
    def attempts_are_bounded(self) -> None:
        policy = self.policy
        repeats = policy.infrastructure_failures + policy.crashes + policy.interruptions - 3
        assert self.starts - self.releases <= repeats + 1


TestLifeOfARun = LifeOfARun.TestCase
