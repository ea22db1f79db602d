"""The intervals of means against SciPy's bootstrap, and their coverage by simulation."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import stats

from drivora_service.suites.paired.bootstrap import mean_intervals


def example() -> NDArray[np.float64]:
    random = np.random.default_rng(7)
    return np.column_stack(
        [
            random.normal(2.0, 1.0, 60),
            random.exponential(3.0, 60),
            np.where(random.random(60) < 0.8, 0.0, random.normal(5.0, 2.0, 60)),
            random.choice([-1.0, 0.0, 1.0], 60, p=[0.1, 0.6, 0.3]),
        ]
    )


def test_they_are_those_of_another_implementation() -> None:
    values = example()
    found = mean_intervals(values, resamples=20_000)
    for column, interval in enumerate(found):
        sample = values[:, column]
        reference = stats.bootstrap(
            (sample,), np.mean, n_resamples=20_000, method="BCa", rng=np.random.default_rng(11)
        ).confidence_interval
        # Both draw 20,000 samples: their ends differ by chance.
        chance = 0.06 * float(sample.std()) / np.sqrt(len(sample))
        assert interval is not None
        assert interval == pytest.approx((reference.low, reference.high), abs=3.0 * chance)


def test_values_that_are_not_measurable_are_left_out() -> None:
    values = example()
    missing = values.copy()
    missing[::3] = np.nan
    known = np.delete(values, slice(None, None, 3), axis=0)
    for with_gaps, alone in zip(mean_intervals(missing), mean_intervals(known), strict=True):
        assert with_gaps is not None
        assert alone is not None
        # The number of values that a sample draws varies: a little wider at most.
        assert with_gaps == pytest.approx(alone, abs=0.2 * (alone[1] - alone[0]))


def test_what_has_no_spread_or_too_few_values() -> None:
    nan = np.nan
    values = np.array([[1.5, nan, 3.0], [1.5, nan, nan], [1.5, nan, nan]])
    assert mean_intervals(values) == ((1.5, 1.5), None, None)
    assert mean_intervals(np.zeros((0, 2))) == (None, None)


@given(
    st.lists(st.sampled_from([-2.0, 0.0, 1.0, 7.0, np.nan]), min_size=1, max_size=12),
    st.sampled_from([1e-200, 1e-160, 1.0, 1e150]),
)
def test_what_is_drawn_has_an_interval_in_its_range(values: list[float], unit: float) -> None:
    """Also of few values, of values that are mostly equal, and of any size."""
    sample = unit * np.array(values)
    (interval,) = mean_intervals(sample[:, None], resamples=200)
    known = sample[np.isfinite(sample)]
    if len(known) < 2:
        assert interval is None
        return
    assert interval is not None
    low, high = interval
    rounding = 1e-9 * unit
    assert known.min() - rounding <= low <= high <= known.max() + rounding


@given(st.floats(-1e9, 1e9), st.integers(2, 30))
def test_equal_values_have_an_interval_without_width(value: float, n: int) -> None:
    (interval,) = mean_intervals(np.full((n, 1), value), resamples=100)
    assert interval == pytest.approx((value, value), rel=1e-12)


def test_the_same_values_have_the_same_intervals() -> None:
    assert mean_intervals(example()) == mean_intervals(example())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("n", "least"), [(20, 0.90), (100, 0.925)], ids=["twenty scenarios", "a hundred"]
)
def test_they_cover_the_true_mean_nearly_as_often_as_they_say(n: int, least: float) -> None:
    random = np.random.default_rng(5)
    trials = 300
    draws: dict[str, tuple[Callable[[], NDArray[np.float64]], float]] = {
        "normal": (lambda: random.normal(0.4, 1.0, n), 0.4),
        "skewed": (lambda: random.exponential(1.0, n), 1.0),
        "shares": (lambda: random.choice([-1.0, 0.0, 1.0], n, p=[0.15, 0.5, 0.35]), 0.2),
    }
    for name, (draw, mean) in draws.items():
        intervals = [
            mean_intervals(draw()[:, None], resamples=1000, seed=trial)[0]
            for trial in range(trials)
        ]
        covered = sum(one is not None and one[0] <= mean <= one[1] for one in intervals) / trials
        # Two standard errors of the simulation below what is promised.
        assert covered > least - 2.0 * np.sqrt(least * (1.0 - least) / trials), (name, covered)
        assert covered < 0.985, (name, covered)
