"""The vector of genes and its bounds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.errors import SearchError
from drivora_service.search.genes import Block, Gene, GeneKind, GeneSpace, Part
from drivora_service.testing.gene_spaces import small_space

SPACE = small_space()


@given(st.integers(0, 2**32 - 1))
def test_samples_are_within_and_survive_the_unit_cube(seed: int) -> None:
    values = SPACE.sample(np.random.default_rng(seed))
    assert SPACE.within(values)
    unit = SPACE.to_unit(values)
    assert ((unit >= 0.0) & (unit <= 1.0)).all()
    assert np.allclose(SPACE.from_unit(unit), values, rtol=0, atol=1e-9)
    whole = SPACE.is_whole
    assert np.array_equal(SPACE.from_unit(unit)[whole], values[whole])


@given(st.lists(st.floats(-1e6, 1e6), min_size=len(SPACE), max_size=len(SPACE)))
def test_clipping_brings_anything_within(values: list[float]) -> None:
    clipped = SPACE.clip(np.array(values))
    assert SPACE.within(clipped)
    assert np.array_equal(SPACE.clip(clipped), clipped)


def test_both_ends_of_whole_genes_are_drawn_as_often_as_the_others() -> None:
    drawn = SPACE.sample(np.random.default_rng(0), 30_000)
    lane = drawn[:, SPACE.blocks[3].index("lane_0")]
    shares = [float(np.mean(lane == value)) for value in (-1.0, 0.0, 1.0)]
    assert shares == pytest.approx([1 / 3] * 3, abs=0.02)


def test_the_bounds_of_the_cube_are_the_bounds_of_the_genes() -> None:
    assert np.array_equal(SPACE.from_unit(np.zeros(len(SPACE))), SPACE.lows)
    assert np.array_equal(SPACE.from_unit(np.ones(len(SPACE))), SPACE.highs)


def test_a_value_out_of_bounds_or_not_whole_is_not_within() -> None:
    values = SPACE.sample(np.random.default_rng(0))
    for index, wrong in ((0, 1.5), (1, 2.5), (2, np.nan), (3, 99.0)):
        changed = values.copy()
        changed[index] = wrong
        assert not SPACE.within(changed)


def test_genes_are_found_by_name() -> None:
    vehicle = SPACE.of(Part.VEHICLE)[1]
    assert SPACE.genes[vehicle.index("speed_2")].name == "speed_2"
    assert [SPACE.genes[i].name for i in vehicle.indices("lane")] == [f"lane_{k}" for k in range(4)]
    with pytest.raises(SearchError, match=r"no gene 'wings'.*present"):
        vehicle.index("wings")


def test_a_space_with_a_gap_or_without_genes_is_refused() -> None:
    gene = Gene(name="x", kind=GeneKind.CONTINUOUS, low=0.0, high=1.0)
    with pytest.raises(SearchError, match="begins at 1"):
        GeneSpace((Block(name="weather", part=Part.WEATHER, start=1, genes=(gene,)),))
    with pytest.raises(SearchError, match="empty"):
        GeneSpace(())
    with pytest.raises(SearchError, match="finite and in order"):
        Gene(name="x", kind=GeneKind.CONTINUOUS, low=1.0, high=0.0)
