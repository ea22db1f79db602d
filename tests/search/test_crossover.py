"""The crossover of actors: the genes that children take from each parent."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.crossover import exchange_block, one_point
from drivora_service.testing.gene_spaces import small_space

SPACE = small_space()
SEEDS = st.integers(0, 2**32 - 1)


def parents(seed: int) -> tuple[FloatArray, FloatArray, np.random.Generator]:
    random = np.random.default_rng(seed)
    return SPACE.sample(random), SPACE.sample(random), random


def exchanged_blocks(child: FloatArray, first: FloatArray) -> list[str]:
    return [b.name for b in SPACE.blocks if not np.array_equal(child[b.slice], first[b.slice])]


@given(seed=SEEDS)
def test_children_are_within_bounds_and_parents_unchanged(seed: int) -> None:
    first, second, random = parents(seed)
    kept = first.copy(), second.copy()
    children = exchange_block(first, second, SPACE, random)
    assert all(SPACE.within(child) for child in children)
    assert np.array_equal(first, kept[0])
    assert np.array_equal(second, kept[1])


@given(seed=SEEDS)
def test_one_child_has_the_genes_that_the_other_has_not(seed: int) -> None:
    first, second, random = parents(seed)
    one, other = exchange_block(first, second, SPACE, random)
    assert np.array_equal(np.sort([one, other], axis=0), np.sort([first, second], axis=0))


def test_children_of_equal_parents_are_equal() -> None:
    first, _, random = parents(0)
    for child in exchange_block(first, first.copy(), SPACE, random):
        assert np.allclose(child, first, rtol=0, atol=1e-9)


@given(SEEDS)
def test_one_actor_is_exchanged(seed: int) -> None:
    first, second, random = parents(seed)
    one, _ = exchange_block(first, second, SPACE, random)
    assert len(exchanged_blocks(one, first)) == 1


def test_only_an_actor_in_which_parents_differ_is_exchanged() -> None:
    first, second, random = parents(0)
    second[: SPACE.blocks[-1].start] = first[: SPACE.blocks[-1].start]
    for _ in range(20):
        one, _ = exchange_block(first, second, SPACE, random)
        assert exchanged_blocks(one, first) == [SPACE.blocks[-1].name]


@given(SEEDS)
def test_one_point_exchanges_all_genes_after_a_point(seed: int) -> None:
    first, second, random = parents(seed)
    kept = first.copy(), second.copy()
    one, other = one_point(first, second, SPACE, random)
    point = int(np.argmax(one != first))
    assert point > 0
    assert np.array_equal(one, np.concatenate((first[:point], second[point:])))
    assert np.array_equal(other, np.concatenate((second[:point], first[point:])))
    assert np.array_equal(first, kept[0])
    assert np.array_equal(second, kept[1])
    # Each child has genes of both.
    for child in (one, other):
        assert not np.array_equal(child, first)
        assert not np.array_equal(child, second)
        assert SPACE.within(child)


def test_one_point_leaves_parents_that_differ_in_one_gene() -> None:
    first, _, random = parents(0)
    second = first.copy()
    gene = int(np.flatnonzero(SPACE.varies)[0])
    second[gene] = SPACE.lows[gene] if first[gene] != SPACE.lows[gene] else SPACE.highs[gene]
    one, other = one_point(first, second, SPACE, random)
    assert np.array_equal(one, first)
    assert np.array_equal(other, second)
