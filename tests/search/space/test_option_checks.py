"""Options that contradict one another or the seed."""

from __future__ import annotations

from dataclasses import replace

import pytest

from drivora_service.errors import SearchError
from drivora_service.scenario.model import NpcBehavior, RouteEnd, Waypoint
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions, VehicleStarts
from tests.search.space.seeds import NETWORKS, seed_scenario


def around(town: str, options: SpaceOptions) -> ScenarioSpace:
    return ScenarioSpace(seed_scenario(town), NETWORKS.get(town), options)


def test_all_that_is_out_of_range_is_named() -> None:
    with pytest.raises(SearchError) as caught:
        around("tee-town", SpaceOptions(egos=0, vehicles=-1, slices=0, reach=5.0))
    assert str(caught.value) == (
        "`egos` is 0; 1 to 64 are allowed; `vehicles` is -1; 0 to 500 are allowed; "
        "`slices` is 0; 1 to 50 are allowed; `reach` is 5; 10 to 1000 are allowed"
    )


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (SpaceOptions(starts=VehicleStarts.FIXED, egos=2), "`starts` is fixed, but `egos` is 2"),
        (
            SpaceOptions(slice_time=3.0, max_wait=5.0),
            "`slice_time` and `max_wait` (5 s) are both given",
        ),
        (
            SpaceOptions(behavior=NpcBehavior.SUMO, at_end=RouteEnd.STAY, max_deceleration=8.0),
            "`behavior` is sumo, but `at_end`, `max_deceleration` cannot be told to SUMO",
        ),
        (
            SpaceOptions(behavior=NpcBehavior.SUMO, slice_time=3.0),
            "`behavior` is sumo, but `slice_time` cannot",
        ),
        (SpaceOptions(max_wait=61.0), "`max_wait` is 61; 0 to 60 are allowed"),
        (SpaceOptions(slice_time=0.1), "`slice_time` is 0.1; 0.5 to 60 are allowed"),
        (
            SpaceOptions(max_lateral_acceleration=0.1),
            "`max_lateral_acceleration` is 0.1; 0.5 to 12 are allowed",
        ),
    ],
)
def test_contradictions_are_named(options: SpaceOptions, said: str) -> None:
    with pytest.raises(SearchError) as caught:
        around("tee-town", options)
    assert str(caught.value).startswith(said)


def test_fewer_egos_than_the_seed_has() -> None:
    seed = seed_scenario("tee-town")
    others = tuple(
        replace(seed_scenario("tee-town", number).ego_vehicles[0], id=f"ego_{number}")
        for number in range(3)
    )
    crowded = replace(seed, ego_vehicles=others)
    with pytest.raises(SearchError, match="`egos` is 2, but the seed scenario has 3 egos"):
        ScenarioSpace(crowded, NETWORKS.get("tee-town"), SpaceOptions(egos=2))
    assert ScenarioSpace(crowded, NETWORKS.get("tee-town"), SpaceOptions(egos=1)).genes


def test_nothing_that_varies() -> None:
    options = SpaceOptions(vehicles=0, walkers=0, weather=False, lights=True)
    with pytest.raises(SearchError, match="vary at least one part"):
        around("highway", options)


def test_a_route_without_a_place_for_a_walker() -> None:
    seed = seed_scenario("tee-town")
    junction = next(
        lane
        for lane in NETWORKS.get("tee-town").lanes
        if lane.is_internal and lane.drivable and lane.arc[-1] > 12.0
    )
    begin, end = junction.position_at(1.0), junction.position_at(float(junction.arc[-1]) - 1.0)
    route = tuple(Waypoint(x=x, y=y, yaw=yaw) for x, y, yaw in (begin, end))
    inside = replace(seed, ego_vehicles=(replace(seed.ego_vehicles[0], route=route),))
    for options, what in (
        (SpaceOptions(vehicles=0), "use no walkers"),
        (SpaceOptions(vehicles=0, walkers=0, obstacles=1), "use no obstacles"),
    ):
        with pytest.raises(SearchError, match=f"route of ego 'ego_0'.*{what}"):
            ScenarioSpace(inside, NETWORKS.get("tee-town"), options)
