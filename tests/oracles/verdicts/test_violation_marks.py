from __future__ import annotations

import numpy as np
import pytest

from drivora_service.observations.run_view import RunView
from drivora_service.oracles.blocked import Blocked
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.oracles.verdicts.violation_marks import marks_of, moments_of
from drivora_service.testing.networks import straight_road
from drivora_service.testing.traces import Motion, SyntheticEgo, make_trace


def verdict(oracle: str, time: float | None) -> Verdict:
    return Verdict(oracle=oracle, ego="ego", outcome=Outcome.VIOLATED, message="", time=time)


def test_numbers_follow_time_and_end_with_what_has_none() -> None:
    marks = marks_of([verdict("a", None), verdict("b", 2.0), verdict("c", 1.0)])
    assert [(mark.number, mark.verdict.oracle) for mark in marks] == [(1, "c"), (2, "b"), (3, "a")]
    assert moments_of(verdict("a", None), 0.05) is None


def test_an_ego_that_stands_for_long_stands_until_it_drives_on() -> None:
    step_length = 0.5
    x = np.concatenate((np.linspace(0.0, 20.0, 20), np.full(160, 20.0), 20.0 + np.arange(20.0)))
    motion = Motion.along(x, 0.0, step_length=step_length)
    trace = make_trace([SyntheticEgo(motion=motion)], step_length=step_length)
    (blocked,) = Blocked().judge(RunView(trace, straight_road()))
    assert blocked.outcome is Outcome.VIOLATED
    moments = moments_of(blocked, step_length)
    assert moments is not None
    standing = np.flatnonzero(np.hypot(*trace.states[:, 0, 3:5].T) < 0.1)
    assert moments.last == standing[-1]
    assert moments.first - standing[0] == pytest.approx(60.0 / step_length, abs=1)
