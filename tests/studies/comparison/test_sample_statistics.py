"""Comparing samples: worked examples, and properties that any such statistic has."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.errors import CampaignError
from drivora_service.studies.comparison.sample_statistics import a12_interval, compare_samples, holm

SAMPLES = st.lists(st.integers(0, 20), min_size=2, max_size=25)


def test_a12_by_hand() -> None:
    # Pairs: (3, 1) (3, 2) (3, 3) larger, larger, tie; (1, 1) tie, (1, 2) (1, 3) smaller.
    assert compare_samples([3, 1], [1, 2, 3]).a12 == pytest.approx((2 + 0.5 + 0.5) / 6)


@given(SAMPLES, SAMPLES)
def test_a12_is_the_share_of_pairs(x: list[int], y: list[int]) -> None:
    pairs = [1.0 if a > b else 0.5 if a == b else 0.0 for a in x for b in y]
    assert compare_samples(x, y).a12 == pytest.approx(np.mean(pairs))


@given(SAMPLES, SAMPLES)
def test_the_other_way_round_everything_is_mirrored(x: list[int], y: list[int]) -> None:
    one, other = compare_samples(x, y), compare_samples(y, x)
    assert one.a12 == pytest.approx(1.0 - other.a12)
    assert one.low == pytest.approx(1.0 - other.high, abs=1e-6)
    assert one.p == pytest.approx(other.p)
    assert 0.0 <= one.low <= one.a12 <= one.high <= 1.0


def test_the_interval_covers_the_true_value_as_often_as_it_says() -> None:
    random = np.random.default_rng(3)
    shift = 0.78  # of unit normals: P(X > Y) = Phi(0.78 / sqrt 2) = 0.709
    covered = 0
    for _ in range(400):
        effect = compare_samples(random.normal(shift, 1.0, 20), random.normal(0.0, 1.0, 20))
        covered += effect.low <= 0.7093 <= effect.high
    assert 0.91 <= covered / 400 <= 0.985


def test_an_interval_at_the_end_has_a_width_that_shrinks_with_the_sample() -> None:
    low, high = a12_interval(1.0, 20, 20)
    assert high == 1.0
    assert 0.75 < low < 0.97
    assert a12_interval(1.0, 80, 80)[0] > low


@given(st.floats(allow_nan=False, allow_infinity=False), st.integers(2, 30), st.integers(2, 30))
def test_equal_values_are_no_difference(value: float, n: int, m: int) -> None:
    effect = compare_samples([value] * n, [value] * m)
    assert (effect.a12, effect.p) == (0.5, 1.0)
    assert 0.0 < effect.low < 0.5 < effect.high < 1.0
    assert effect.low == pytest.approx(1.0 - effect.high, abs=1e-6)


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=2, max_size=20))
def test_a_sample_does_not_differ_from_itself(sample: list[float]) -> None:
    effect = compare_samples(sample, sample[::-1])
    assert (effect.a12, effect.p) == (0.5, 1.0)


@given(SAMPLES, SAMPLES)
def test_every_comparison_has_a_p(x: list[int], y: list[int]) -> None:
    assert 0.0 <= compare_samples(x, y).p <= 1.0


def test_samples_of_one_value_differ_by_chance_only() -> None:
    effect = compare_samples([4, 4, 4], [4, 4])
    assert (effect.a12, effect.p) == (0.5, 1.0)


def test_holm_by_hand() -> None:
    assert holm([0.01, 0.04, 0.03]) == pytest.approx((0.03, 0.06, 0.06))
    assert holm([0.5, 0.9]) == pytest.approx((1.0, 1.0))
    assert holm([]) == ()


@given(st.lists(st.floats(0.0, 1.0), max_size=8))
def test_holm_never_lowers_and_keeps_the_order(values: list[float]) -> None:
    corrected = holm(values)
    assert all(c >= v for c, v in zip(corrected, values, strict=True))
    order = np.argsort(values, kind="stable")
    assert np.all(np.diff(np.array(corrected)[order]) >= 0.0)


@given(st.lists(st.floats(0.0, 1.0), max_size=8), st.integers(0, 8))
def test_holm_refuses_what_has_no_order(values: list[float], place: int) -> None:
    values.insert(place, math.nan)
    with pytest.raises(CampaignError, match=r"not a number: .*nan"):
        holm(values)


def test_unusable_samples_are_refused() -> None:
    with pytest.raises(CampaignError, match="1 repetitions"):
        compare_samples([1.0], [1.0, 2.0])
    with pytest.raises(CampaignError, match="not finite"):
        compare_samples([1.0, float("nan")], [1.0, 2.0])
