"""Rates of failing simulations, their intervals, and what they mean for a comparison."""

from __future__ import annotations

import pytest
from scipy import stats

from drivora_service.studies.failure_rates import (
    TOO_FREQUENT,
    TOO_RARE,
    FailureRate,
    describe_rate,
    percent,
)


@pytest.mark.parametrize(("failing", "simulations"), [(0, 100), (1, 100), (31, 50), (50, 50)])
def test_the_interval_is_that_of_clopper_and_pearson(failing: int, simulations: int) -> None:
    rate = FailureRate(failing=failing, simulations=simulations)
    known = stats.binomtest(failing, simulations).proportion_ci(method="exact")
    assert rate.low == pytest.approx(known.low, abs=1e-9)
    assert rate.high == pytest.approx(known.high, abs=1e-9)


def test_without_simulations_nothing_is_known() -> None:
    rate = FailureRate(failing=0, simulations=0)
    assert rate.rate is None
    assert (rate.low, rate.high) == (0.0, 1.0)
    assert not rate.is_too_rare
    assert not rate.is_too_frequent
    assert "nothing is known" in describe_rate(rate)


def test_the_words_follow_the_thresholds() -> None:
    count = 2000
    rare = FailureRate(failing=int(TOO_RARE * count) - 1, simulations=count)
    useful = FailureRate(failing=int(TOO_RARE * count), simulations=count)
    half = FailureRate(failing=int(TOO_FREQUENT * count), simulations=count)
    frequent = FailureRate(failing=int(TOO_FREQUENT * count) + 1, simulations=count)
    assert (rare.is_too_rare, useful.is_too_rare) == (True, False)
    assert (half.is_too_frequent, frequent.is_too_frequent) == (False, True)
    assert "methods hardly differ" in describe_rate(rare)
    assert "methods can differ" in describe_rate(useful)
    assert "about 2 simulations to a failure" in describe_rate(half)
    assert "tells little" in describe_rate(frequent)


def test_none_of_a_hundred_bounds_the_rate() -> None:
    words = describe_rate(FailureRate(failing=0, simulations=100))
    assert words.startswith("0 of 100 fail (0 %): a rate above 3 % is unlikely; below 0.5 %")
    assert "make more" not in words
    assert "make more" in describe_rate(FailureRate(failing=0, simulations=20))


def test_shares_are_written_with_two_digits_at_most() -> None:
    shares = (0.0, 0.0004, 0.036, 0.62, 1.0)
    assert [percent(one) for one in shares] == ["0 %", "0.04 %", "3.6 %", "62 %", "100 %"]
