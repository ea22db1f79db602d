"""McNemar's test and Tango's interval against independent arithmetic."""

from __future__ import annotations

import math
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import optimize

from drivora_service.suites.paired.mcnemar import compare_shares, mcnemar_p, tango_interval

Z = 1.959963984540054


def by_hand(first: int, second: int) -> float:
    """Two tails of a fair coin, from binomial coefficients."""
    n, less = first + second, min(first, second)
    tail = sum(math.comb(n, k) for k in range(less + 1)) / 2**n
    return float(min(1.0, 2.0 * tail))


def test_every_small_table_is_the_sum_of_binomial_coefficients() -> None:
    for first, second in product(range(25), repeat=2):
        assert mcnemar_p(first, second) == pytest.approx(by_hand(first, second), abs=1e-12)


def test_worked_examples() -> None:
    # 2 (1 + 16 + 120 + 560 + 1820) / 2^16
    assert mcnemar_p(4, 12) == pytest.approx(2 * 2517 / 65536)
    assert mcnemar_p(0, 5) == pytest.approx(0.0625)
    assert mcnemar_p(0, 6) == pytest.approx(0.03125)
    assert mcnemar_p(0, 0) == 1.0


def score(more: int, less: int, n: int, delta: float) -> float:
    """The score statistic with the constrained maximum of the likelihood found numerically."""

    def loss(other: float) -> float:
        # Shares of the cells: more = other + delta, less = other, the rest 1 - both.
        shares = ((more, other + delta), (less, other), (n - more - less, 1 - 2 * other - delta))
        return -sum(count * math.log(max(share, 1e-300)) for count, share in shares if count)

    low, high = max(0.0, -delta), (1.0 - delta) / 2.0
    best = optimize.minimize_scalar(loss, bounds=(low, high), options={"xatol": 1e-13}).x
    variance = (2.0 * best + delta - delta * delta) / n
    return float((more - less) / n - delta) / math.sqrt(variance)


@given(
    st.integers(1, 40).flatmap(
        lambda n: st.tuples(st.just(n), st.integers(0, n), st.integers(0, n))
    )
)
def test_the_ends_of_the_interval_are_where_the_score_test_stops_rejecting(
    table: tuple[int, int, int],
) -> None:
    n, more, less = table
    less = min(less, n - more)
    low, high = tango_interval(more, less, n)
    assert -1.0 <= low <= (more - less) / n <= high <= 1.0
    if low > -0.999:
        assert score(more, less, n, low) == pytest.approx(Z, abs=2e-3)
    if high < 0.999:
        assert score(more, less, n, high) == pytest.approx(-Z, abs=2e-3)


@given(st.integers(0, 30), st.integers(0, 30), st.integers(0, 60))
def test_zero_is_outside_exactly_where_the_chi_square_of_mcnemar_is_large(
    more: int, less: int, alike: int
) -> None:
    if not more + less:
        return
    low, high = tango_interval(more, less, more + less + alike)
    chi_square = (more - less) ** 2 / (more + less)
    if abs(chi_square - Z * Z) > 1e-6:
        assert (low > 0.0 or high < 0.0) == (chi_square > Z * Z)


def test_the_interval_covers_the_true_difference_as_often_as_it_says() -> None:
    # Exactly, over all tables of 24 pairs.
    n = 24
    intervals = {
        (more, less): tango_interval(more, less, n)
        for more in range(n + 1)
        for less in range(n + 1 - more)
    }
    for p_more, p_less in ((0.05, 0.05), (0.1, 0.3), (0.02, 0.2), (0.3, 0.3)):
        covered = 0.0
        for (more, less), (low, high) in intervals.items():
            if low <= p_more - p_less <= high:
                rest = n - more - less
                ways = math.comb(n, more) * math.comb(n - more, less)
                covered += ways * p_more**more * p_less**less * (1 - p_more - p_less) ** rest
        assert 0.925 <= covered <= 0.995, (p_more, p_less)


def test_no_pair_that_differs_does_not_mean_no_difference() -> None:
    shares = compare_shares(a_only=0, b_only=0, scenarios=50)
    assert shares is not None
    assert (shares.difference, shares.p) == (0.0, 1.0)
    assert shares.low == pytest.approx(-shares.high)
    assert 0.05 < shares.high < 0.1
    assert compare_shares(a_only=0, b_only=0, scenarios=0) is None


@given(st.integers(0, 30), st.integers(0, 30), st.integers(0, 30))
def test_every_table_has_a_p_and_an_interval(a_only: int, b_only: int, alike: int) -> None:
    scenarios = a_only + b_only + alike
    shares = compare_shares(a_only=a_only, b_only=b_only, scenarios=scenarios)
    if not scenarios:
        assert shares is None
        return
    assert shares is not None
    assert 0.0 < shares.p <= 1.0
    assert -1.0 <= shares.low <= shares.difference <= shares.high <= 1.0
    if a_only == b_only:
        assert shares.p == pytest.approx(1.0)


def test_less_is_better_for_b() -> None:
    shares = compare_shares(a_only=12, b_only=4, scenarios=100)
    assert shares is not None
    assert shares.difference == pytest.approx(-0.08)
    assert shares.low < -0.08 < shares.high
