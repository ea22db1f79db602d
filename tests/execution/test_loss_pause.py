"""The pause after attempts that were lost one after the other."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

import pytest

from drivora_service.execution.loss_pause import LossPause
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import NOT_BEGUN
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus


def ended(
    status: RunStatus = RunStatus.FINISHED, *, run_id: str = "run", cause: str = "", took: float = 0
) -> AttemptEnd:
    now = datetime.now(UTC)
    failure = RunFailure(cause=cause, message="") if cause else None
    report = RunReport(run_id=run_id, status=status, failure=failure)
    return AttemptEnd(
        report=report, worker="slot-0", started=now - timedelta(seconds=took), ended=now
    )


def lost(run_id: str, *, cause: str = "trace_not_written", took: float = 0) -> AttemptEnd:
    return ended(RunStatus.INFRASTRUCTURE_FAILED, run_id=run_id, cause=cause, took=took)


@dataclass
class Clock:
    now: float = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def pause(clock: Clock) -> LossPause:
    return LossPause(clock)


def test_one_lost_attempt_begins_none(pause: LossPause) -> None:
    for _ in range(3):
        assert pause.note(lost("a")) == 0.0
        assert not pause.is_on
        assert pause.note(ended()) == 0.0


def test_two_in_a_row_begin_one_that_ends(pause: LossPause, clock: Clock) -> None:
    assert [pause.note(lost("a")), pause.note(lost("b"))] == [0.0, 2.0]
    clock.now += 1.9
    assert pause.is_on
    clock.now += 0.2
    assert not pause.is_on


def test_a_run_that_has_one_attempt_left_waits_longer(pause: LossPause) -> None:
    assert [pause.note(lost("a")), pause.note(lost("a"))] == [0.0, 8.0]


@pytest.mark.parametrize("took", [0.0, 3.0])
def test_what_was_running_when_it_began_makes_it_no_longer(
    pause: LossPause, clock: Clock, took: float
) -> None:
    pause.note(lost("a"))
    pause.note(lost("b"))
    # Lost in the pause, or later, but begun before its end.
    clock.now += 0.5 + took
    assert sum(pause.note(lost(name, took=took)) for name in "cdef") == 0.0
    clock.now += 2.0
    assert not pause.is_on


def test_it_is_longer_each_time_up_to_a_bound(pause: LossPause, clock: Clock) -> None:
    pauses = []
    pause.note(lost("a"))
    for name in "bcde":
        pauses.append(pause.note(lost(name)))
        clock.now += pauses[-1] + 0.1
    assert pauses == [2.0, 8.0, 30.0, 30.0]


@pytest.mark.parametrize("status", [RunStatus.FINISHED, RunStatus.SIMULATOR_CRASHED])
def test_another_end_ends_it_and_the_next_one_is_short_again(
    pause: LossPause, clock: Clock, status: RunStatus
) -> None:
    pause.note(lost("a"))
    pause.note(lost("b"))
    clock.now += 3.0
    assert pause.note(lost("c")) == 8.0
    pause.note(ended(status))
    assert not pause.is_on
    assert [pause.note(lost("a")), pause.note(lost("b"))] == [0.0, 2.0]


@pytest.mark.parametrize("status", [RunStatus.CANCELLED, RunStatus.INVALID])
def test_ends_that_show_nothing_do_not_end_it(pause: LossPause, status: RunStatus) -> None:
    pause.note(lost("a"))
    pause.note(ended(status))
    assert pause.note(lost("b")) == 2.0
    pause.note(ended(status))
    assert pause.is_on


@pytest.mark.parametrize("cause", [NOT_BEGUN, "agent_killed", "worker_stopped"])
def test_losses_that_other_runs_need_not_meet_do_not_count(pause: LossPause, cause: str) -> None:
    assert sum(pause.note(lost(name, cause=cause)) for name in "abcde") == 0.0
    assert not pause.is_on
