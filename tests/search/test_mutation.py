"""Mutations: the contract, and what each one changes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.search.genes import GeneKind, slices_of
from drivora_service.search.mutation import (
    GAUSSIAN,
    REDRAW_BLOCK,
    REDRAW_GENE,
    REDRAW_SLICE,
    GaussianMutation,
    RedrawBlock,
    RedrawGene,
    RedrawSlice,
    effective_genes,
    redraw_genes,
    shift_genes,
)
from drivora_service.testing.gene_spaces import small_space
from drivora_service.testing.mutation_contract import MutationContract

SPACE = small_space()
VEHICLE = SPACE.blocks[3]
SEEDS = st.integers(0, 2**32 - 1)


class TestGaussian(MutationContract):
    plugin = GAUSSIAN


class TestRedrawGene(MutationContract):
    plugin = REDRAW_GENE


class TestRedrawBlock(MutationContract):
    plugin = REDRAW_BLOCK


class TestRedrawSlice(MutationContract):
    plugin = REDRAW_SLICE


def all_present(random: np.random.Generator) -> FloatArray:
    """Returns a candidate in which every actor is present."""
    values = SPACE.sample(random)
    for block in SPACE.blocks:
        if block.is_optional:
            values[block.start] = 1.0
    return values


def all_genes() -> BoolArray:
    return np.ones(len(SPACE), dtype=np.bool_)


@given(SEEDS)
def test_genes_of_the_absent_have_no_effect(seed: int) -> None:
    values = SPACE.sample(np.random.default_rng(seed))
    effective = effective_genes(values, SPACE)
    for block in SPACE.blocks:
        absent = block.is_optional and values[block.start] == 0.0
        expected = SPACE.varies[block.slice].copy()
        if absent:
            expected[1:] = False
        assert np.array_equal(effective[block.slice], expected)


@given(SEEDS)
def test_redrawn_whole_genes_have_another_value_and_the_rest_stays(seed: int) -> None:
    random = np.random.default_rng(seed)
    values = SPACE.sample(random)
    which = random.random(len(SPACE)) < 0.5
    child = redraw_genes(values, SPACE, random, which)
    assert SPACE.within(child)
    assert np.array_equal(child != values, which & SPACE.varies)


def test_redrawing_draws_all_other_values_alike() -> None:
    random = np.random.default_rng(0)
    path = VEHICLE.index("path")
    values = all_present(random)
    values[path] = 4.0
    drawn = [redraw_genes(values, SPACE, random, all_genes())[path] for _ in range(9000)]
    counts = np.bincount(np.array(drawn, dtype=np.int64), minlength=10)
    assert counts[4] == 0
    assert np.abs(np.delete(counts, 4) / 9000 - 1 / 9).max() < 0.02


@given(SEEDS, st.floats(0.01, 100.0))
def test_shifting_stays_within_and_moves_whole_genes_by_at_least_one(
    seed: int, sigma: float
) -> None:
    random = np.random.default_rng(seed)
    values = SPACE.sample(random)
    which = random.random(len(SPACE)) < 0.5
    child = shift_genes(values, SPACE, random, which & ~SPACE.is_category, sigma)
    assert SPACE.within(child)
    assert np.array_equal(child[~which], values[~which])


def test_a_shift_has_the_deviation_that_was_asked_for() -> None:
    random = np.random.default_rng(0)
    values = all_present(random)
    speed, along = VEHICLE.index("speed_1"), VEHICLE.index("along_1")
    values[[speed, along]] = 9.0, 0.0
    sigma = np.zeros(len(SPACE))
    sigma[[speed, along]] = 1.5, 3.0
    moved = np.array([shift_genes(values, SPACE, random, sigma > 0, sigma) for _ in range(4000)])
    assert moved[:, speed].std() == pytest.approx(1.5, rel=0.05)
    assert moved[:, along].std() == pytest.approx(3.0, rel=0.05)
    assert moved[:, speed].mean() == pytest.approx(9.0, abs=0.1)


def test_bounds_do_not_fill_up() -> None:
    random = np.random.default_rng(0)
    speed = VEHICLE.index("speed_1")
    values = all_present(random)
    values[speed] = SPACE.highs[speed] - 0.1
    child = [shift_genes(values, SPACE, random, all_genes(), 2.0)[speed] for _ in range(500)]
    assert max(child) < SPACE.highs[speed]
    assert np.mean(np.array(child) < values[speed]) > 0.9


def test_gaussian_moves_magnitudes_at_its_rate_by_its_share_of_the_range() -> None:
    random = np.random.default_rng(0)
    mutation = GaussianMutation(rate=0.3, sigma=0.02, category_rate=0.0)
    speeds = [i for b in SPACE.blocks for i in b.indices("speed")]
    paths = np.flatnonzero(SPACE.is_category)
    moves = []
    for _ in range(300):
        parent = all_present(random)
        moves.append(mutation.mutate(parent, SPACE, random) - parent)
    changes = np.array(moves)
    assert (changes[:, paths] == 0).all()
    share = np.mean(changes[:, speeds] != 0)
    assert share == pytest.approx(0.3, abs=0.03)
    moved = changes[:, speeds][changes[:, speeds] != 0]
    assert moved.std() == pytest.approx(0.02 * 18.0, rel=0.1)


def test_gaussian_redraws_categories_at_their_rate() -> None:
    random = np.random.default_rng(0)
    mutation = GaussianMutation(rate=0.0, category_rate=0.2)
    paths = np.flatnonzero(SPACE.is_category)
    shares = []
    for _ in range(300):
        parent = all_present(random)
        shares.append(np.mean((mutation.mutate(parent, SPACE, random) != parent)[paths]))
    assert np.mean(shares) == pytest.approx(0.2, abs=0.03)


@given(SEEDS)
def test_one_gene_is_one_gene_that_has_an_effect(seed: int) -> None:
    random = np.random.default_rng(seed)
    parent = SPACE.sample(random)
    for mutation in (RedrawGene(), RedrawSlice()):
        changed = mutation.mutate(parent, SPACE, random) != parent
        assert changed.sum() == 1
        assert effective_genes(parent, SPACE)[changed].all()


@given(SEEDS)
def test_one_block_is_one_block_and_the_absent_appear(seed: int) -> None:
    random = np.random.default_rng(seed)
    parent = SPACE.sample(random)
    child = RedrawBlock().mutate(parent, SPACE, random)
    changed = [b for b in SPACE.blocks if not np.array_equal(child[b.slice], parent[b.slice])]
    assert len(changed) == 1
    if changed[0].is_optional and parent[changed[0].start] == 0.0:
        assert child[changed[0].start] == 1.0


def test_strength_is_the_number_of_genes() -> None:
    random = np.random.default_rng(0)
    counts = []
    for _ in range(500):
        parent = all_present(random)
        counts.append(np.sum(RedrawGene().mutate(parent, SPACE, random, strength=2.5) != parent))
    assert set(counts) == {2, 3}
    assert np.mean(counts) == pytest.approx(2.5, abs=0.1)


def test_slices_hold_the_genes_of_one_number_and_the_rest_is_one_more() -> None:
    groups = slices_of(VEHICLE, SPACE.varies)
    names = [[SPACE.genes[i].name for i in group] for group in groups]
    assert names[0] == ["present", "model", "path", "start"]
    assert names[1] == ["speed_0", "lane_0", "along_0"]
    assert len(names) == 5


def test_every_actor_and_every_slice_of_it_is_redrawn_as_often() -> None:
    random = np.random.default_rng(0)
    blocks = np.zeros(len(SPACE.blocks))
    groups = slices_of(VEHICLE, SPACE.varies)
    hits = np.zeros(len(groups))
    parent = all_present(random)
    for _ in range(6000):
        changed = int(np.flatnonzero(RedrawSlice().mutate(parent, SPACE, random) != parent)[0])
        blocks[next(i for i, b in enumerate(SPACE.blocks) if b.start <= changed < b.stop)] += 1
        hits += [changed in group for group in groups]
    assert np.abs(blocks / 6000 - 1 / len(blocks)).max() < 0.02
    assert np.abs(hits / hits.sum() - 1 / len(groups)).max() < 0.07


def test_the_small_space_has_genes_of_every_kind() -> None:
    assert {gene.kind for gene in SPACE.genes} == set(GeneKind)
