"""Distances between candidates."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.search import distance
from drivora_service.search.distance import candidate_distances, farthest
from drivora_service.search.genes import GeneKind
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


@given(st.integers(0, 2**32 - 1))
def test_every_actor_is_compared_gene_by_gene(seed: int) -> None:
    one, other = SPACE.sample(np.random.default_rng(seed), 2)
    distances = []
    for block in SPACE.blocks:
        squares = []
        is_absent = [block.is_optional and v[block.start] == 0.0 for v in (one, other)]
        for index, gene in enumerate(block.genes, start=block.start):
            if gene.low == gene.high:
                continue
            mine, theirs = one[index], other[index]
            if index > block.start and any(is_absent):
                # An absent actor's category is none of the values, its magnitudes are the least.
                mine, theirs = (
                    (gene.low if gene.kind is not GeneKind.CATEGORY else -1.0) if absent else value
                    for absent, value in zip(is_absent, (mine, theirs), strict=True)
                )
            if gene.kind is GeneKind.CATEGORY:
                squares.append(float(mine != theirs))
            else:
                squares.append(((mine - theirs) / (gene.high - gene.low)) ** 2)
        distances.append(np.sqrt(np.mean(squares)))
    found = candidate_distances(one[None], other[None], SPACE)
    assert found[0, 0] == pytest.approx(np.mean(distances))


def farthest_of_all(values: FloatArray, past: FloatArray, counts: IntArray) -> IntArray:
    """Returns the rows from the farthest to the nearest, by all distances."""
    repeated = np.repeat(past, counts, axis=0)
    return np.argsort(-candidate_distances(values, repeated, SPACE).mean(axis=1), kind="stable")


@pytest.mark.parametrize("others", [1, 7, 70])
@pytest.mark.parametrize("wanted", [1, 4, 50])
def test_the_farthest_are_those_of_all_mean_distances(others: int, wanted: int) -> None:
    random = np.random.default_rng(others)
    values, past = SPACE.sample(random, 50), SPACE.sample(random, others)
    counts = random.integers(1, 5, size=others)
    found = farthest(values, past, counts.astype(np.float64), SPACE, wanted)
    assert np.array_equal(found, farthest_of_all(values, past, counts)[:wanted])


def test_few_candidates_are_compared_with_all_others(monkeypatch: pytest.MonkeyPatch) -> None:
    random = np.random.default_rng(3)
    values, past = SPACE.sample(random, 1000), SPACE.sample(random, 200)
    compared: list[int] = []
    original = distance._distances

    def counting(left: FloatArray, right: FloatArray) -> FloatArray:
        compared.append(len(left))
        return original(left, right)

    monkeypatch.setattr(distance, "_distances", counting)
    farthest(values, past, np.ones(200), SPACE, 4)
    assert sum(compared) <= 100 * len(SPACE.blocks)


def test_of_equal_candidates_the_first_are_the_farthest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(distance, "_TILE", 210)
    random = np.random.default_rng(2)
    past = SPACE.sample(random, 70)
    values = np.repeat(SPACE.sample(random, 3), 40, axis=0)
    counts = np.ones(70)
    order = farthest_of_all(values[::40], past, counts.astype(np.int64))
    found = farthest(values, past, counts, SPACE, 41)
    assert set(found // 40) == {order[0], order[1]}
    assert np.count_nonzero(found // 40 == order[1]) == 1
