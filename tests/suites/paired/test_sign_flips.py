"""The test by flipped signs against all flips, and how often it is wrong."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from drivora_service.suites.paired.mcnemar import mcnemar_p
from drivora_service.suites.paired.metric_differences import flip_p_values


def all_flips(values: list[float]) -> float:
    """The share of all flips whose sum is at least as far from zero."""
    total = abs(sum(values))
    sums = [
        abs(sum(s * v for s, v in zip(signs, values, strict=True)))
        for signs in product((-1, 1), repeat=len(values))
    ]
    return sum(one >= total - 1e-12 for one in sums) / len(sums)


def test_p_is_the_share_of_all_flips() -> None:
    columns = [
        [0.3, 1.2, 0.8, -0.1, 2.0, 0.9, 0.4, 1.1, 0.2, -0.6],
        [0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0],
        [0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7, -0.8, 0.9, -1.0],
    ]
    found = flip_p_values(np.array(columns).T, flips=50_000)
    assert found == pytest.approx([all_flips(column) for column in columns], abs=0.01)


def test_of_failures_it_is_the_exact_test_of_mcnemar() -> None:
    values = np.array([1.0] * 12 + [-1.0] * 4 + [0.0] * 20)[:, None]
    (p,) = flip_p_values(values, flips=50_000)
    assert p == pytest.approx(mcnemar_p(4, 12), abs=0.005)


def test_five_scenarios_that_differ_show_nothing() -> None:
    values = np.array([3.0, 1.0, 4.0, 1.5, 9.0] + [0.0] * 95)[:, None]
    assert flip_p_values(values)[0] > 0.05


def test_nothing_and_gaps() -> None:
    assert flip_p_values(np.zeros((4, 1))) == (1.0,)
    assert flip_p_values(np.full((4, 1), np.nan)) == (1.0,)
    values = np.array([1.0, 2.0, -0.5, 3.0, 0.7, 1.1])
    gaps = np.concatenate([values, [np.nan, np.nan]])
    assert flip_p_values(gaps[:, None])[0] == pytest.approx(all_flips(values.tolist()), abs=0.02)


@pytest.mark.slow(seconds=20)
@pytest.mark.parametrize("n", [8, 25, 80])
def test_equal_agents_are_told_apart_in_one_of_twenty_comparisons_at_most(n: int) -> None:
    random = np.random.default_rng(n)
    trials = 500
    kinds = (
        lambda: random.normal(0.0, 1.0, n),
        lambda: random.standard_t(2.0, n),
        lambda: np.where(random.random(n) < 0.8, 0.0, random.normal(0.0, 30.0, n)),
    )
    for kind in kinds:
        wrong = sum(
            flip_p_values(kind()[:, None], flips=999, seed=trial)[0] < 0.05
            for trial in range(trials)
        )
        # Three standard errors above 5 per cent.
        assert wrong / trials < 0.05 + 3.0 * np.sqrt(0.05 * 0.95 / trials)
