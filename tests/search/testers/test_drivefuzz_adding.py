"""What DriveFuzz adds to scenarios, in spaces around real seeds."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.scenario.validation import scenario_problems
from drivora_service.search.genes import Block, GeneSpace, Part
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.search.testers.drivefuzz.adding import Adding
from drivora_service.testing.gene_spaces import small_space
from tests.search.space.seeds import NETWORKS, space_around

OPTIONS = SpaceOptions(vehicles=4, walkers=3, obstacles=2, patches=2, optional=True)


def adding(
    space: ScenarioSpace | GeneSpace,
    seed: int = 3,
    chances: tuple[float, float] = (0.25, 0.25),
    reach: tuple[float, float] = (5.0, 40.0),
) -> Adding:
    genes = space.genes if isinstance(space, ScenarioSpace) else space
    return Adding(
        genes,
        np.random.default_rng(seed),
        distance=space.ego_distance if isinstance(space, ScenarioSpace) else None,
        reach=reach,
        chances=chances,
        tries=50,
    )


def new_block(space: ScenarioSpace, before: FloatArray, after: FloatArray) -> Block:
    (block,) = (
        b for b in space.genes.blocks if not np.array_equal(before[b.slice], after[b.slice])
    )
    return block


@pytest.mark.parametrize("town", ["tee-town", "signal-grid", "highway"])
def test_new_actors_appear_five_to_forty_metres_from_the_ego(town: str) -> None:
    space = space_around(town, OPTIONS)
    add = adding(space, chances=(0.0, 0.0))
    parent = add.blank()
    start = space.routes[0].path.at(0.0)
    away, parts = [], Counter[Part]()
    for _ in range(60):
        mutant = add.add(parent)
        scenario = space.scenario(mutant.values)
        parts[mutant.part] += 1
        places = [vehicle.route[0] for vehicle in scenario.npc_vehicles]
        places += [walker.route[0] for walker in scenario.npc_walkers]
        places += [one.location for one in scenario.npc_obstacles]
        (place,) = places
        away.append(math.hypot(place.x - start.x, place.y - start.y))
    within = [5.0 <= distance <= 40.0 for distance in away]
    # Not every road has room for every draw: of those that have none, the nearest is taken.
    assert np.mean(within) > 0.9
    assert set(parts) == {Part.VEHICLE, Part.WALKER, Part.OBSTACLE}
    # A third of all are immobile, and so obstacles.
    assert 10 <= parts[Part.OBSTACLE] <= 32


def test_mutants_of_ten_cycles_are_valid_scenarios() -> None:
    space = space_around("tee-town", OPTIONS)
    add = adding(space)
    values, invalid = add.blank(), 0
    for _ in range(20):
        values = add.add(values).values
        assert space.genes.within(values)
        scenario = space.scenario(space.repair(values))
        invalid += bool(scenario_problems(scenario, NETWORKS, ("idm",)))
    assert invalid <= 2


def test_what_is_added_stays_with_the_seeds_own_and_is_full_in_the_end() -> None:
    space = space_around("tee-town", OPTIONS)
    add = adding(space)
    values = add.blank()
    assert not space.scenario(values).friction_patches
    for _ in range(200):
        values = add.add(values).values
    scenario = space.scenario(values)
    counts = [len(getattr(scenario, name)) for name in (
        "npc_vehicles", "npc_walkers", "npc_obstacles", "friction_patches",
    )]  # fmt: skip
    assert counts == [4, 3, 2, 2]


def test_linear_vehicles_go_straight_on_at_one_speed_and_others_do_not() -> None:
    space = space_around("tee-town", SpaceOptions(vehicles=2, walkers=0, optional=True))
    add = adding(space, chances=(0.0, 0.0))
    parent, steady, slow, own = add.blank(), 0, 0, 0
    for _ in range(90):
        block = new_block(space, parent, values := add.add(parent).values)
        speeds = values[list(block.indices("speed"))]
        aside = values[[*block.indices("lane"), *block.indices("along")]]
        if np.ptp(speeds) > 0.0:
            own += 1
            assert aside.any()
        else:
            assert not aside.any()
            low = block.genes[0].high + 1.0
            slow += bool(speeds[0] == pytest.approx(low))
            steady += bool(speeds[0] > low + 1e-9)
    # Without obstacles in the space, the immobile ones are as slow as can be.
    assert min(steady, slow, own) > 15


def test_what_a_space_has_not_is_not_drawn() -> None:
    without = small_space(egos=0, walkers=0)
    parts = Counter(adding(without, seed).add(adding(without).blank()).part for seed in range(80))
    assert set(parts) == {Part.VEHICLE, Part.WEATHER}
    # Two thirds of what is left: one half to one quarter.
    assert 40 <= parts[Part.VEHICLE] <= 66


def test_chances_are_shares() -> None:
    space = small_space(egos=0, patches=2)
    parts = Counter(adding(space, seed).add(adding(space).blank()).part for seed in range(400))
    assert parts[Part.PATCH] / 400 == pytest.approx(0.25, abs=0.07)
    assert parts[Part.WEATHER] / 400 == pytest.approx(0.25, abs=0.07)
    assert parts[Part.VEHICLE] > 50
    assert parts[Part.WALKER] > 50


def test_the_sun_of_a_seed_is_high() -> None:
    space = space_around("tee-town", OPTIONS)
    weather = space.scenario(adding(space).blank()).weather
    assert weather.sun_altitude_angle == 90.0
    assert (weather.precipitation, weather.wetness, weather.fog_density) == (0.0, 0.0, 0.0)
