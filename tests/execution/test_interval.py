from __future__ import annotations

from drivora_service.execution.interval import Interval


def test_it_is_over_at_the_beginning_and_when_it_is_ended() -> None:
    interval = Interval(1000.0)
    assert interval.is_over()
    assert not interval.is_over()
    interval.end()
    assert interval.is_over()
    assert not interval.is_over()


def test_it_is_over_after_its_time() -> None:
    interval = Interval(0.0)
    assert interval.is_over()
    assert interval.is_over()
