"""NPC vehicles from genes: on their paths, in order, no faster than allowed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import example, given, settings
from hypothesis import strategies as st

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.networks.projection import lane_positions_near
from drivora_service.scenario.model import NpcBehavior, NpcVehicle
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import LEAST_SPEED, SpaceOptions
from drivora_service.search.space.vehicles.npc_paths import NpcPath
from drivora_service.search.space.vehicles.vehicle_genes import MODELS
from drivora_service.simulation.plans.planning_npcs import plan_npc
from tests.search.space.seeds import SHIPPED, block_named, drawn, space_around

ONE = SpaceOptions(vehicles=1, walkers=0, weather=False)


def with_genes(space: ScenarioSpace, values: FloatArray, **genes: float) -> FloatArray:
    """Values with some genes of the first vehicle set."""
    changed = values.copy()
    for name, value in genes.items():
        changed[block_named(space, "vehicle_0").index(name)] = value
    return changed


def first_vehicle(space: ScenarioSpace, values: FloatArray) -> tuple[NpcVehicle, NpcPath]:
    path = space.paths[int(values[block_named(space, "vehicle_0").index("path")])]
    return space.scenario(values).npc_vehicles[0], path


def middle(space: ScenarioSpace) -> FloatArray:
    """Every gene in the middle of its bounds."""
    return space.genes.clip(0.5 * (space.genes.lows + space.genes.highs))


def assert_follows_its_path(space: ScenarioSpace, values: FloatArray) -> None:
    vehicle, path = first_vehicle(space, values)
    line = plan_npc(vehicle, space.network, 1.0).path.line
    driven = path.path
    off = shapely.distance(shapely.points(line), shapely.LineString(driven.line)).max()
    widest = max(space.network.lanes[lane].width for lane, _, _ in driven.lane_ranges)
    assert off <= widest + 0.7
    begin, _ = driven.place_of(vehicle.route[0].x, vehicle.route[0].y)
    end, _ = driven.place_of(vehicle.route[-1].x, vehicle.route[-1].y)
    length = float(np.hypot(*np.diff(line, axis=0).T).sum())
    assert length == pytest.approx(end - begin, abs=6.0)


@pytest.mark.parametrize("behavior", [NpcBehavior.REACTIVE, NpcBehavior.REPLAY])
@pytest.mark.parametrize("town", SHIPPED)
def test_the_planned_way_is_the_path(town: str, behavior: NpcBehavior) -> None:
    space = space_around(
        town, SpaceOptions(vehicles=1, walkers=0, weather=False, behavior=behavior)
    )
    for number in range(15):
        assert_follows_its_path(space, drawn(space, number))


def test_the_planned_way_is_the_path_in_real_towns(shared_data: Path) -> None:
    towns = NetworkCatalogue(shared_data / "maps")
    for town in ("Town01", "Town02", "Town04"):
        space = space_around(town, ONE, networks=towns)
        for number in range(15):
            assert_follows_its_path(space, drawn(space, number))


@pytest.mark.parametrize("town", ["tee-town", "arterial"])
def test_every_path_is_driven_by_a_vehicle(town: str) -> None:
    space = space_around(town, ONE)
    for number, path in enumerate(space.paths):
        values = with_genes(space, middle(space), path=number, start=0.0)
        vehicle, chosen = first_vehicle(space, values)
        assert chosen is path
        start = path.path.at(path.start_at(0.0))
        assert (vehicle.route[0].x, vehicle.route[0].y) == pytest.approx(
            (start.x, start.y), abs=0.002
        )
        assert_follows_its_path(space, values)


@settings(max_examples=25)
@example(number=59780, town="tee-town")
@given(number=st.integers(0, 2**32 - 1), town=st.sampled_from(SHIPPED))
def test_waypoints_are_in_order_on_lanes_and_within_the_limits(number: int, town: str) -> None:
    space = space_around(town, ONE)
    vehicle, path = first_vehicle(space, drawn(space, number))
    assert vehicle.model in MODELS
    assert vehicle.start_time == 0.0
    places = [path.path.place_of(place.x, place.y)[0] for place in vehicle.route]
    assert places == sorted(places)
    for place, s in zip(vehicle.route, places, strict=True):
        near = lane_positions_near(space.network, place.x, place.y, heading=place.yaw)[0]
        assert abs(near.lateral) < 0.5
        assert place.speed is not None
        limit = max(path.path.limit_at(s - 1.5), path.path.limit_at(s + 1.5))
        assert LEAST_SPEED <= place.speed <= max(1.3 * limit, LEAST_SPEED) + 0.001
    assert len(vehicle.route) >= ONE.slices


def test_speeds_are_those_of_the_genes() -> None:
    space = space_around("tee-town", ONE)
    wanted = {"speed_0": 3.0, "speed_1": 4.0, "speed_2": 5.0, "speed_3": 6.0, "speed_4": 7.0}
    vehicle, _ = first_vehicle(space, with_genes(space, middle(space), path=0, **wanted))
    speeds = [place.speed for place in vehicle.route]
    assert speeds[:2] == [3.0, 3.0]
    assert sorted({speed or 0.0 for speed in speeds}) == list(wanted.values())


def test_a_shift_moves_one_waypoint_along_the_path() -> None:
    space = space_around("rural", ONE)
    path = next(i for i, path in enumerate(space.paths) if not path.path.in_junction.any())
    plain, way = first_vehicle(space, with_genes(space, middle(space), path=path))
    moved, _ = first_vehicle(space, with_genes(space, middle(space), path=path, along_2=9.0))
    before, after = (
        [way.path.place_of(place.x, place.y)[0] for place in one.route] for one in (plain, moved)
    )
    steps = np.subtract(after, before)
    assert steps[3] == pytest.approx(9.0, abs=1.1)
    assert np.delete(steps, 3) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("town", ["highway", "arterial"])
def test_a_lane_gene_puts_a_waypoint_on_the_neighbouring_lane(town: str, side: int) -> None:
    space = space_around(town, ONE)
    moved = 0
    for number in range(len(space.paths)):
        plain = with_genes(space, middle(space), path=number, lane_2=0)
        beside = with_genes(space, plain, lane_2=side)
        one, other = (first_vehicle(space, values)[0].route for values in (plain, beside))
        different = [pair for pair in zip(one, other, strict=True) if pair[0] != pair[1]]
        for here, there in different:
            own, wanted = (
                lane_positions_near(space.network, place.x, place.y, heading=place.yaw)[0].lane
                for place in (here, there)
            )
            lane = space.network.lanes[own]
            assert wanted == (lane.left if side > 0 else lane.right)
        assert len(different) <= 1
        moved += len(different)
        assert_follows_its_path(space, beside)
    assert moved >= 2


def test_a_lane_gene_means_nothing_where_there_is_one_lane() -> None:
    space = space_around("rural", ONE)
    block = block_named(space, "vehicle_0")
    assert {block.genes[i - block.start].high for i in block.indices("lane")} == {0.0}


def test_speeds_do_not_change_where_it_drives() -> None:
    space = space_around("signal-grid", ONE)
    slow = with_genes(space, middle(space), **{f"speed_{k}": 2.0 for k in range(5)})
    fast = with_genes(space, middle(space), **{f"speed_{k}": 15.0 for k in range(5)})
    one, other = (first_vehicle(space, values)[0] for values in (slow, fast))
    assert [(p.x, p.y, p.yaw) for p in one.route] == [(p.x, p.y, p.yaw) for p in other.route]
    assert one.route != other.route
