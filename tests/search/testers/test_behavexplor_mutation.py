"""Noise on waypoints."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.genes import Block, Gene, GeneKind, GeneSpace, Part
from drivora_service.search.testers.behavexplor.mutation import WaypointNoise
from drivora_service.testing.gene_spaces import small_space

SPACE = small_space()
WIDE = GeneSpace(
    (
        Block(
            name="vehicle_0",
            part=Part.VEHICLE,
            start=0,
            genes=tuple(
                Gene(name=f"{name}_{k}", kind=GeneKind.CONTINUOUS, low=-1000.0, high=1000.0)
                for name in ("speed", "along")
                for k in range(3)
            ),
        ),
    )
)
"""Waypoints alone, with bounds that no noise reaches."""


def mutants(
    space: GeneSpace, values: FloatArray, noise: WaypointNoise, count: int = 3000
) -> FloatArray:
    random = np.random.default_rng(5)
    return np.array([noise.mutate(values, space, random) - values for _ in range(count)])


def test_the_noise_is_that_of_the_paper() -> None:
    moves = mutants(WIDE, np.zeros(6), WaypointNoise(probability=1.0))
    np.testing.assert_allclose(moves[:, :3].std(axis=0), 6.0, rtol=0.06)
    np.testing.assert_allclose(moves[:, 3:].std(axis=0), 12.0, rtol=0.06)
    np.testing.assert_allclose(moves.mean(axis=0), 0.0, atol=0.8)


def test_the_strength_scales_it() -> None:
    noise, random = WaypointNoise(probability=1.0), np.random.default_rng(5)
    moves = [noise.mutate(np.zeros(6), WIDE, random, strength=0.5) for _ in range(2000)]
    np.testing.assert_allclose(np.std(moves, axis=0)[:3], 3.0, rtol=0.08)


def test_half_of_the_waypoints_move_and_each_as_a_whole() -> None:
    moved = mutants(WIDE, np.zeros(6), WaypointNoise()) != 0.0
    np.testing.assert_array_equal(moved[:, :3], moved[:, 3:])
    # At least one of three moves: (1/2 + 1/8 / 3) of them on average.
    assert moved.mean() == pytest.approx(0.5 + 0.125 / 3.0, abs=0.02)
    assert moved.any(axis=1).all()
    pairs = np.corrcoef(moved[:, :3].T)
    assert np.abs(pairs[~np.eye(3, dtype=bool)]).max() < 0.2


def test_types_paths_and_lanes_stay() -> None:
    random = np.random.default_rng(2)
    whole = SPACE.is_whole
    for values in SPACE.sample(random, 200):
        mutant = WaypointNoise().mutate(values, SPACE, random)
        np.testing.assert_array_equal(mutant[whole], values[whole])


def test_a_spread_of_0_moves_nothing_but_waypoints() -> None:
    random = np.random.default_rng(3)
    values = SPACE.sample(random)
    for block in SPACE.of(Part.VEHICLE):
        values[block.start] = 1.0
    moved = mutants(SPACE, values, WaypointNoise(spread=0.0), 300).any(axis=0)
    waypoints = np.zeros(len(SPACE), dtype=np.bool_)
    for block in SPACE.of(Part.VEHICLE):
        waypoints[[*block.indices("along"), *block.indices("speed")]] = True
    np.testing.assert_array_equal(moved, waypoints)


def test_other_magnitudes_move_each_for_itself() -> None:
    values = SPACE.from_unit(np.full(len(SPACE), 0.5))
    (weather,) = SPACE.of(Part.WEATHER)
    moved = mutants(SPACE, values, WaypointNoise(), 2000)[:, weather.slice] != 0.0
    np.testing.assert_allclose(moved.mean(axis=0), 0.5, atol=0.05)
    assert np.abs(np.corrcoef(moved.T)[0, 1]) < 0.1


def test_absent_actors_are_left_alone() -> None:
    values = SPACE.from_unit(np.full(len(SPACE), 0.5))
    block = SPACE.of(Part.VEHICLE)[0]
    values[block.start] = 0.0
    assert not mutants(SPACE, values, WaypointNoise(), 200)[:, block.slice].any()


@given(st.integers(0, 2**32 - 1), st.floats(0.01, 1.0))
def test_mutants_are_other_candidates_within_the_bounds(seed: int, probability: float) -> None:
    random = np.random.default_rng(seed)
    values = SPACE.sample(random)
    before = values.copy()
    mutant = WaypointNoise(probability=probability).mutate(values, SPACE, random)
    assert SPACE.within(mutant)
    assert not np.array_equal(mutant, values)
    np.testing.assert_array_equal(values, before)
