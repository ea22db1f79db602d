"""Statistics of gates, against other computations."""

from __future__ import annotations

from itertools import product
from math import comb

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from drivora_service.suites.gate.occurrence_statistics import (
    Occurrences,
    mean_of_repetitions,
    p_of_more,
    p_of_more_overall,
    share,
)

COUNTS = st.integers(0, 30).flatmap(
    lambda of: st.builds(Occurrences, runs=st.integers(0, of), of=st.just(of))
)


def test_p_of_more_counts_the_ways_to_distribute_the_failures() -> None:
    for n0, n1 in product(range(1, 6), range(1, 6)):
        for k0, k1 in product(range(n0 + 1), range(n1 + 1)):
            total = k0 + k1
            ways = sum(
                comb(n1, k) * comb(n0, total - k)
                for k in range(k1, min(n1, total) + 1)
                if total - k <= n0
            )
            expected = ways / comb(n0 + n1, total)
            found = p_of_more(Occurrences(runs=k0, of=n0), Occurrences(runs=k1, of=n1))
            assert found == pytest.approx(expected, abs=1e-12)
            table = np.array([[k1, n1 - k1], [k0, n0 - k0]])
            assert found == pytest.approx(stats.fisher_exact(table, "greater").pvalue, abs=1e-9)


@given(COUNTS, COUNTS)
def test_every_pair_of_counts_has_a_p(before: Occurrences, now: Occurrences) -> None:
    """Also where there was no run, no failure, or nothing else."""
    p = p_of_more(before, now)
    assert 0.0 < p <= 1.0 + 1e-12
    if not now.runs:
        assert p == 1.0


@given(st.lists(st.tuples(COUNTS, COUNTS), max_size=5))
def test_an_overall_p_is_a_number(pairs: list[tuple[Occurrences, Occurrences]]) -> None:
    p = p_of_more_overall(pairs)
    assert p is None or 0.0 <= p <= 1.0


@given(COUNTS)
def test_the_interval_of_a_share_holds_the_share(counts: Occurrences) -> None:
    found = share(counts.runs, counts.of)
    assert 0.0 <= found.least <= found.mean <= found.most <= 1.0


@given(st.floats(-1e9, 1e9), st.integers(1, 30), st.floats(0.5, 0.999))
def test_equal_repetitions_have_no_width(value: float, n: int, confidence: float) -> None:
    found = mean_of_repetitions([value] * n, confidence=confidence)
    assert found.mean == pytest.approx(value, rel=1e-12)
    assert found.most - found.least <= 1e-9 * abs(value)


def test_the_overall_p_is_about_that_of_shuffling_within_each_scenario() -> None:
    rng = np.random.default_rng(3)
    pairs = [(int(rng.integers(0, 4)), 8, int(rng.integers(1, 6)), 8) for _ in range(12)]
    found = p_of_more_overall(
        (Occurrences(runs=k0, of=n0), Occurrences(runs=k1, of=n1)) for k0, n0, k1, n1 in pairs
    )
    observed = sum(k1 for _, _, k1, _ in pairs)
    draws = np.zeros(200_000)
    for k0, n0, k1, n1 in pairs:
        draws += rng.hypergeometric(k0 + k1, n0 + n1 - k0 - k1, n1, len(draws))
    shuffled = np.mean(draws >= observed)
    assert 1e-4 < shuffled < 0.1
    assert found == pytest.approx(shuffled, rel=0.25)


def test_the_overall_p_is_none_where_nothing_can_differ() -> None:
    none, every = Occurrences(runs=0, of=3), Occurrences(runs=3, of=3)
    assert p_of_more_overall([(none, none), (every, every)]) is None
    assert p_of_more_overall([(Occurrences(runs=0, of=0), every)]) is None
    assert p_of_more_overall([]) is None


def test_the_overall_p_is_not_small_without_a_change() -> None:
    same = Occurrences(runs=2, of=5)
    p = p_of_more_overall([(same, same)] * 40)
    assert p is not None
    assert p > 0.4


def test_intervals_hold_the_mean_as_often_as_they_say() -> None:
    rng = np.random.default_rng(5)
    held = 0
    for _ in range(1000):
        interval = mean_of_repetitions(list(rng.normal(3.0, 2.0, 5)), confidence=0.9)
        held += interval.least <= 3.0 <= interval.most
    assert 870 <= held <= 930


def test_a_single_repetition_has_no_interval() -> None:
    interval = mean_of_repetitions([4.0], confidence=0.95)
    assert (interval.mean, interval.low, interval.high) == (4.0, None, None)
    assert (interval.least, interval.most, str(interval)) == (4.0, 4.0, "4")
    equal = mean_of_repetitions([4.0, 4.0], confidence=0.95)
    assert (equal.low, equal.high) == (4.0, 4.0)
