"""Crossovers: the genes that children take from each parent."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.geometry.arrays import FloatArray
from drivora_service.search.crossover import (
    Crossover,
    exchange_block,
    one_point,
    simulated_binary,
    uniform,
)
from drivora_service.testing.gene_spaces import small_space

SPACE = small_space()
SEEDS = st.integers(0, 2**32 - 1)
EXCHANGING = (exchange_block, one_point, uniform)
ALL = (*EXCHANGING, simulated_binary)


def parents(seed: int) -> tuple[FloatArray, FloatArray, np.random.Generator]:
    random = np.random.default_rng(seed)
    return SPACE.sample(random), SPACE.sample(random), random


def exchanged_blocks(child: FloatArray, first: FloatArray) -> list[str]:
    return [b.name for b in SPACE.blocks if not np.array_equal(child[b.slice], first[b.slice])]


@pytest.mark.parametrize("crossover", ALL)
@given(seed=SEEDS)
def test_children_are_within_and_parents_stay(crossover: Crossover, seed: int) -> None:
    first, second, random = parents(seed)
    kept = first.copy(), second.copy()
    children = crossover(first, second, SPACE, random)
    assert all(SPACE.within(child) for child in children)
    assert np.array_equal(first, kept[0])
    assert np.array_equal(second, kept[1])


@pytest.mark.parametrize("crossover", EXCHANGING)
@given(seed=SEEDS)
def test_what_one_child_has_not_the_other_has(crossover: Crossover, seed: int) -> None:
    first, second, random = parents(seed)
    one, other = crossover(first, second, SPACE, random)
    assert np.array_equal(np.sort([one, other], axis=0), np.sort([first, second], axis=0))


@pytest.mark.parametrize("crossover", ALL)
def test_children_of_equal_parents_are_equal(crossover: Crossover) -> None:
    first, _, random = parents(0)
    for child in crossover(first, first.copy(), SPACE, random):
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


def test_all_actors_behind_one_point_are_exchanged() -> None:
    first, second, random = parents(0)
    names = [b.name for b in SPACE.blocks]
    lengths = set()
    for _ in range(300):
        found = exchanged_blocks(one_point(first, second, SPACE, random)[0], first)
        assert found == names[-len(found) :]
        lengths.add(len(found))
    assert lengths == set(range(1, len(names)))


def test_half_of_the_genes_are_exchanged() -> None:
    random = np.random.default_rng(0)
    first, second = SPACE.lows, SPACE.highs
    taken = [uniform(first, second, SPACE, random)[0] == second for _ in range(400)]
    assert np.mean(np.array(taken)[:, SPACE.varies], axis=0) == pytest.approx(0.5, abs=0.12)


@given(SEEDS)
def test_spread_children_take_their_categories_from_their_parents(seed: int) -> None:
    first, second, random = parents(seed)
    for child in simulated_binary(first, second, SPACE, random):
        where = SPACE.is_category
        assert np.all((child[where] == first[where]) | (child[where] == second[where]))


def test_spread_children_lie_around_both_parents_and_nearer_with_greater_eta() -> None:
    first, second, random = parents(0)
    genes = ~SPACE.is_whole & (np.abs(first - second) > 1e-3)
    distances = []
    for eta in (2.0, 30.0):
        spread = partial(simulated_binary, eta=eta, rate=1.0)
        children = [spread(first, second, SPACE, random) for _ in range(200)]
        one = np.array([pair[0][genes] for pair in children])
        other = np.array([pair[1][genes] for pair in children])
        # Where neither child meets a bound, they are symmetric about their parents' middle.
        middle = np.median(one + other, axis=0)
        assert np.allclose(middle, (first + second)[genes], rtol=0.15, atol=0.3)
        near = np.minimum(np.abs(one - first[genes]), np.abs(one - second[genes]))
        distances.append(float(np.mean(near / np.abs(first - second)[genes])))
    assert distances[1] < 0.5 * distances[0]
