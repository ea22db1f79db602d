"""The pause after attempts that were lost one after the other."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from drivora_service.execution.loss_pause import LossPause
from drivora_service.runs.lifecycle import NOT_BEGUN
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus

FINISHED = RunReport(run_id="fine", status=RunStatus.FINISHED)


def lost(cause: str = "trace_not_written") -> RunReport:
    failure = RunFailure(cause=cause, message="")
    return RunReport(run_id="lost", status=RunStatus.INFRASTRUCTURE_FAILED, failure=failure)


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
        assert pause.note(lost()) == 0.0
        assert not pause.is_on
        assert pause.note(FINISHED) == 0.0


def test_two_in_a_row_begin_one_that_ends(pause: LossPause, clock: Clock) -> None:
    assert [pause.note(lost()), pause.note(lost())] == [0.0, 2.0]
    clock.now += 1.9
    assert pause.is_on
    clock.now += 0.2
    assert not pause.is_on


def test_what_was_running_when_it_began_makes_it_no_longer(pause: LossPause, clock: Clock) -> None:
    assert sum(pause.note(lost()) for _ in range(9)) == 2.0
    clock.now += 2.1
    assert not pause.is_on


def test_it_is_longer_each_time_up_to_a_bound(pause: LossPause, clock: Clock) -> None:
    pauses = []
    pause.note(lost())
    for _ in range(4):
        pauses.append(pause.note(lost()))
        clock.now += pauses[-1] + 0.1
    assert pauses == [2.0, 10.0, 30.0, 30.0]


def test_another_end_ends_it_and_the_next_one_is_short_again(
    pause: LossPause, clock: Clock
) -> None:
    pause.note(lost())
    pause.note(lost())
    clock.now += 3.0
    assert pause.note(lost()) == 10.0
    pause.note(RunReport(run_id="crash", status=RunStatus.SIMULATOR_CRASHED))
    assert not pause.is_on
    assert [pause.note(lost()), pause.note(lost())] == [0.0, 2.0]


def test_an_attempt_that_a_lost_node_had_not_begun_does_not_count(pause: LossPause) -> None:
    assert sum(pause.note(lost(NOT_BEGUN)) for _ in range(5)) == 0.0
    assert not pause.is_on
