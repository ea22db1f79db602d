"""Distances between candidates."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.search.distance import candidate_distances
from drivora_service.testing.gene_spaces import small_space

SPACE = small_space()
VEHICLE = SPACE.blocks[3]


@given(st.integers(0, 2**32 - 1))
def test_they_are_distances(seed: int) -> None:
    values = SPACE.sample(np.random.default_rng(seed), 6)
    found = candidate_distances(values, values, SPACE)
    assert np.diagonal(found) == pytest.approx(0.0)
    assert found == pytest.approx(found.T)
    assert ((found >= 0.0) & (found <= 1.0)).all()
    for k in range(6):
        assert (found <= found[:, [k]] + found[[k], :] + 1e-12).all()


def test_one_gene_counts_as_its_share_of_the_actor() -> None:
    one = SPACE.lows.copy()
    one[VEHICLE.start] = 1.0
    for name, change, part in (("speed_0", 9.0, 0.5), ("path", 1.0, 1.0), ("path", 7.0, 1.0)):
        other = one.copy()
        other[VEHICLE.index(name)] += change
        expected = np.sqrt(part**2 / len(VEHICLE.genes)) / len(SPACE.blocks)
        assert candidate_distances(one[None], other[None], SPACE)[0, 0] == pytest.approx(expected)


def test_the_genes_of_the_absent_do_not_count() -> None:
    one, other = SPACE.sample(np.random.default_rng(0), 2)
    other[:] = one
    one[VEHICLE.start] = other[VEHICLE.start] = 0.0
    other[VEHICLE.start + 1 : VEHICLE.stop] = SPACE.highs[VEHICLE.start + 1 : VEHICLE.stop]
    assert candidate_distances(one[None], other[None], SPACE) == 0.0
    other[VEHICLE.start] = 1.0
    assert candidate_distances(one[None], other[None], SPACE) > 0.0
