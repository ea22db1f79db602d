"""Situations: discrete keys of failures, which depend on nothing but the failure."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.studies.situations import count_situations, situation_of


def violation(
    x: float | None = 0.0, y: float = 0.0, *, oracle: str = "collision", **evidence: object
) -> Verdict:
    return Verdict(
        oracle=oracle,
        ego="ego_0",
        outcome=Outcome.VIOLATED,
        message="",
        at_fault=True,
        time=1.0,
        location=None if x is None else (x, y),
        evidence=evidence,
    )


def count(*violations: Verdict) -> int:
    return count_situations([(one.oracle, one) for one in violations])


def test_places_are_told_apart_by_squares_of_ten_metres() -> None:
    assert count(violation(1.0), violation(9.9), violation(5.0, 3.0)) == 1
    assert count(violation(9.9), violation(10.1)) == 2
    assert count(violation(-0.1), violation(0.1)) == 2
    assert count(violation(1.0, 1.0), violation(1.0, 11.0)) == 2


def test_speeds_are_told_apart_by_five_metres_a_second() -> None:
    speeds = (4.9, 5.1, 9.9, 10.0)
    assert count(*(violation(ego_speed=speed) for speed in speeds)) == 3
    assert count(*(violation(oracle="red_light", speed=speed) for speed in speeds)) == 3
    assert count(*(violation(ego_speed=7.0, other_speed=speed) for speed in speeds)) == 3


def test_other_evidence_and_the_time_tell_nothing_apart() -> None:
    assert count(violation(face="front", relative_speed=3.0), violation(depth=4.0)) == 1


def test_kinds_are_told_apart() -> None:
    same = violation()
    assert count_situations([("collision|road a", same), ("collision|road b", same)]) == 2


@pytest.mark.parametrize("speed", [None, True, "fast", np.nan, np.inf])
def test_what_is_not_measured_tells_nothing_apart(speed: object) -> None:
    assert situation_of("c", violation(None, ego_speed=speed)) == ("c", None, None, None, None)


FAILURES = st.lists(
    st.builds(
        lambda x, y, speed, kind: (kind, violation(x, y, ego_speed=speed)),
        st.floats(-200.0, 200.0),
        st.floats(-200.0, 200.0),
        st.floats(0.0, 40.0),
        st.sampled_from(["collision|a", "collision|b", "off_road|a"]),
    ),
    max_size=30,
)


@given(FAILURES, FAILURES)
def test_the_situations_of_campaigns_can_be_put_together(
    one: list[tuple[str, Verdict]], other: list[tuple[str, Verdict]]
) -> None:
    together = count_situations([*one, *other])
    assert max(count_situations(one), count_situations(other)) <= together
    assert together <= count_situations(one) + count_situations(other)
    assert together == count_situations([*other, *one])
    assert count_situations([*one, *one]) == count_situations(one)
