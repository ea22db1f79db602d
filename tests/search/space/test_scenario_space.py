"""Scenarios decoded from genes: valid, within the options, and the same each time."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.geometry.boxes import box_gap
from drivora_service.geometry.outlines import box_corners
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.model import (
    NpcBehavior,
    NpcObstacle,
    NpcVehicle,
    Scenario,
)
from drivora_service.scenario.validation import scenario_problems, validate_document
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.simulation.planning import plan_episode
from tests.search.space.seeds import (
    NETWORKS,
    SHIPPED,
    block_named,
    drawn,
    seed_scenario,
    space_around,
)

FULL = SpaceOptions(egos=3, vehicles=3, walkers=2, obstacles=2, lights=True, optional=True)
ONE_EGO = SpaceOptions(vehicles=3, walkers=1, obstacles=1, lights=True)


def invalid(space: ScenarioSpace, networks: NetworkCatalogue, count: int) -> int:
    samples = space.genes.sample(np.random.default_rng(3), count)
    scenarios = (space.scenario(space.repair(values)) for values in samples)
    return sum(bool(scenario_problems(scenario, networks, ["idm"])) for scenario in scenarios)


@pytest.mark.parametrize("options", [ONE_EGO, FULL])
@pytest.mark.parametrize("town", SHIPPED)
def test_repaired_samples_are_valid(town: str, options: SpaceOptions) -> None:
    assert invalid(space_around(town, options), NETWORKS, 12) == 0


@pytest.mark.slow
@pytest.mark.parametrize("behavior", list(NpcBehavior))
@pytest.mark.parametrize("town", SHIPPED)
def test_none_of_many_samples_is_invalid(town: str, behavior: NpcBehavior) -> None:
    options = replace(FULL, behavior=behavior)
    for number in range(3):
        assert invalid(space_around(town, options, number), NETWORKS, 16) == 0


def test_samples_are_valid_in_real_towns(shared_data: Path) -> None:
    towns = NetworkCatalogue(shared_data / "maps")
    for town in ("Town01", "Town02", "Town04"):
        assert invalid(space_around(town, ONE_EGO, networks=towns), towns, 12) == 0


@settings(max_examples=25)
@given(number=st.integers(0, 2**32 - 1), town=st.sampled_from(SHIPPED))
def test_repaired_values_are_within_the_bounds_and_stay(number: int, town: str) -> None:
    space = space_around(town, FULL)
    values = space.genes.sample(np.random.default_rng(number)) * 1.3
    given_values = values.copy()
    repaired = space.repair(values)
    assert np.array_equal(values, given_values)
    assert space.genes.within(repaired)
    assert np.array_equal(space.repair(repaired), repaired)


@settings(max_examples=25)
@given(number=st.integers(0, 2**32 - 1), town=st.sampled_from(SHIPPED))
def test_a_decoded_scenario_is_what_its_document_validates_to(number: int, town: str) -> None:
    space = space_around(town, FULL)
    scenario = space.scenario(drawn(space, number))
    assert validate_document(to_document(scenario), NETWORKS, ["idm"]).scenario == scenario


@settings(max_examples=25)
@given(number=st.integers(0, 2**32 - 1), town=st.sampled_from(SHIPPED))
def test_no_actor_starts_near_an_ego_or_in_another_actor(number: int, town: str) -> None:
    space = space_around(town, replace(ONE_EGO, vehicles=6))
    plan = plan_episode(space.scenario(drawn(space, number)), space.network)
    (ego,) = plan.egos
    boxes = [(*ego.start, ego.model)] + [
        (*follower.path.line[0], follower.path.yaw[0], follower.model)
        for follower in plan.followers
        if follower.role.value == "npc_vehicle"
    ]
    for one, other in combinations(boxes, 2):
        gap = box_gap(
            other[0] - one[0], other[1] - one[1],
            one[2], one[3].length, one[3].width, other[2], other[3].length, other[3].width,
        )  # fmt: skip
        assert gap > 0.25
    x, y, yaw, model = boxes[0]
    ahead = box_corners(np.array([x]), np.array([y]), np.array([yaw]), model.length + 12.0, 1.0)[0]
    for other in boxes[1:]:
        centre, half = ahead.mean(axis=0), 0.5 * (model.length + 12.0)
        gap = box_gap(
            other[0] - centre[0], other[1] - centre[1], yaw, 2.0 * half, 1.0,
            other[2], other[3].length, other[3].width,
        )  # fmt: skip
        assert gap > 0.0


@pytest.mark.parametrize("town", ["tee-town", "highway"])
def test_the_same_seed_gives_the_same_space(town: str) -> None:
    space = space_around(town, FULL)
    again = ScenarioSpace(space.seed, space.network, FULL)
    assert again.genes.blocks == space.genes.blocks
    for number in range(5):
        values = drawn(space, number)
        assert np.array_equal(again.repair(values), values)
        assert canonical_json(again.scenario(values)) == canonical_json(space.scenario(values))


def test_blocks_are_named_and_laid_out_as_agreed() -> None:
    space = space_around("tee-town", FULL)
    assert [block.name for block in space.genes.blocks] == [
        "ego_0", "ego_1", "ego_2", "vehicle_0", "vehicle_1", "vehicle_2", "walker_0", "walker_1",
        "obstacle_0", "obstacle_1", "weather", "lights",
    ]  # fmt: skip
    names = {block.part: [gene.name for gene in block.genes] for block in space.genes.blocks}
    assert {part.value: genes for part, genes in names.items()} == {
        "ego": ["present", "path", "start", "start_time"],
        "vehicle": [
            "present", "model", "path", "start",
            *[f"{name}_{k}" for name in ("speed", "lane", "along") for k in range(5)],
        ],
        "walker": ["present", "path", "place", "side", "angle", "speed", "start_time"],
        "obstacle": ["present", "model", "path", "place", "lateral", "yaw"],
        "weather": ["precipitation", "wetness", "fog_density", "cloudiness", "sun_altitude_angle"],
        "lights": ["green", "offset"],
    }  # fmt: skip


def test_absent_actors_are_left_out() -> None:
    space = space_around("tee-town", FULL)
    values = drawn(space, 1)
    for block in space.genes.blocks:
        if block.is_optional:
            values[block.start] = 0.0
    scenario = space.scenario(space.repair(values))
    assert len(scenario.ego_vehicles) == 2
    assert not scenario.npc_vehicles
    assert not scenario.npc_walkers
    assert not scenario.npc_obstacles
    values[block_named(space, "vehicle_1").start] = 1.0
    assert [npc.id for npc in space.scenario(space.repair(values)).npc_vehicles] == ["vehicle_1"]


def test_actors_are_always_there_unless_they_are_optional() -> None:
    space = space_around("tee-town", ONE_EGO)
    assert not any(block.is_optional for block in space.genes.blocks)
    scenario = space.scenario(drawn(space, 1))
    assert [npc.id for npc in scenario.npc_vehicles] == ["vehicle_0", "vehicle_1", "vehicle_2"]
    assert [walker.id for walker in scenario.npc_walkers] == ["walker_0"]
    assert [obstacle.id for obstacle in scenario.npc_obstacles] == ["obstacle_0"]


def crowded_seed() -> Scenario:
    """A seed with actors of its own, one of which has the name of a new one."""
    space = space_around("tee-town", ONE_EGO)
    own = space.scenario(drawn(space, 5))
    return replace(own, seed=77, step_length=0.1)


def test_the_seeds_own_actors_stay() -> None:
    seed = crowded_seed()
    space = ScenarioSpace(seed, NETWORKS.get("tee-town"), ONE_EGO)
    for number in range(20):
        scenario = space.scenario(drawn(space, number))
        assert scenario.npc_vehicles[:3] == seed.npc_vehicles
        assert scenario.npc_walkers[0] == seed.npc_walkers[0]
        assert scenario.npc_obstacles[0] == seed.npc_obstacles[0]
        assert [npc.id for npc in scenario.npc_vehicles[3:]] == [
            "vehicle_0.1", "vehicle_1.1", "vehicle_2.1",
        ]  # fmt: skip
        assert (scenario.seed, scenario.step_length) == (77, 0.1)
        assert not scenario_problems(scenario, NETWORKS, ["idm"])


def test_a_parked_vehicle_of_the_seed_is_driven_around() -> None:
    plain = space_around("rural", SpaceOptions(vehicles=1, walkers=0, weather=False))
    path = plain.paths[0]
    place = path.path.at(path.start_at(0.5))
    parked = NpcVehicle(id="wreck", model="vehicle.nissan.micra", route=(place.waypoint(),))
    seed = replace(plain.seed, npc_vehicles=(parked,))
    space = ScenarioSpace(seed, plain.network, SpaceOptions(vehicles=1, walkers=0, weather=False))
    block = block_named(space, "vehicle_0")
    values = drawn(space, 1)
    values[[block.index("path"), block.index("start")]] = 0.0, 0.5
    repaired = space.repair(values)
    assert repaired[block.index("start")] != 0.5
    assert repaired[block.index("path")] == 0.0
    assert not scenario_problems(space.scenario(repaired), NETWORKS, ["idm"])


def test_what_is_wrong_with_a_scenario_is_told() -> None:
    seed = seed_scenario("tee-town")
    start = seed.ego_vehicles[0].route[0]
    for actors in (
        {"npc_obstacles": (NpcObstacle(id="box", model="static.prop.box01", location=start),)},
        {"ego_vehicles": (*seed.ego_vehicles, replace(seed.ego_vehicles[0], id="twin"))},
    ):
        broken = replace(seed, **actors)
        assert [p.code for p in scenario_problems(broken, NETWORKS, ["idm"])] == [
            "overlapping_start"
        ]
    assert not scenario_problems(seed, NETWORKS, ["idm"])
