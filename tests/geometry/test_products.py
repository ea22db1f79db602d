"""Sums of products: their terms are added in their order."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.geometry.layers import exp32, product, products, tanh32
from drivora_service.geometry.products import correlate, moving_mean


def test_terms_are_added_one_after_another() -> None:
    random = np.random.default_rng(5)
    values, weights = random.normal(size=(2, 40)), random.normal(size=7)
    found = correlate(values, weights)
    assert found.shape == (2, 34)
    for row in range(2):
        for i in range(34):
            total = 0.0
            for k in range(7):
                total += float(values[row, i + k]) * float(weights[k])
            assert found[row, i] == total


def test_a_moving_mean_of_equal_numbers_is_that_number() -> None:
    assert moving_mean(np.full(20, 3.0), 4).tolist() == [3.0] * 17


@pytest.mark.parametrize("shape", [(1, 1), (4, 2), (7, 3), (40, 130)])
def test_products_of_matrices_have_the_terms_in_their_order(shape: tuple[int, int]) -> None:
    random = np.random.default_rng(6)
    k, m = shape
    rows = random.normal(size=(4, k)).astype(np.float32)
    weights = random.normal(size=(k, m)).astype(np.float32)
    expected = np.zeros((4, m), dtype=np.float32)
    for i in range(k):
        expected += rows[:, i, None] * weights[i]
    found = product(rows, weights)
    assert found.dtype == np.float32
    assert found.tolist() == expected.tolist()
    assert product(rows[1], weights).tolist() == expected[1].tolist()
    assert product(rows[::2], weights).tolist() == expected[::2].tolist()


def test_several_products_are_those_of_each_pair() -> None:
    random = np.random.default_rng(7)
    left = random.normal(size=(3, 5, 4)).astype(np.float32)
    right = random.normal(size=(6, 4, 3)).astype(np.float32).transpose(2, 1, 0)
    found = products(left, right)
    for h in range(3):
        assert found[h].tolist() == product(left[h], np.ascontiguousarray(right[h])).tolist()
    np.testing.assert_allclose(found, left @ right, rtol=1e-5, atol=1e-5)


def test_functions_of_float32_are_rounded_once() -> None:
    values = np.linspace(-4.0, 4.0, 1001, dtype=np.float32)
    expected = np.tanh(values.astype(np.longdouble)).astype(np.float32)
    assert tanh32(values).tolist() == expected.tolist()
    assert exp32(values).dtype == np.float32
    np.testing.assert_allclose(exp32(values), np.exp(values), rtol=3e-7)
