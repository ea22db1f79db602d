"""Several egos from genes: on conflicting routes near the seed's."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.errors import SearchError
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.routes.routing import plan_route
from drivora_service.scenario.checks.route_checks import route_points
from drivora_service.scenario.model import AgentChoice, MapRegion, Region
from drivora_service.search.genes import Part
from drivora_service.search.space.scenario_space import ScenarioSpace
from drivora_service.search.space.space_options import SpaceOptions
from tests.search.space.seeds import (
    NETWORKS,
    SHIPPED,
    block_named,
    drawn,
    seed_scenario,
    space_around,
)

THREE = SpaceOptions(egos=3, vehicles=0, walkers=0, weather=False)


def with_ego(space: ScenarioSpace, values: FloatArray, number: int, **genes: float) -> FloatArray:
    changed = values.copy()
    for name, value in genes.items():
        changed[block_named(space, f"ego_{number}").index(name)] = value
    return changed


def test_one_ego_is_the_seeds() -> None:
    space = space_around("tee-town")
    assert not space.genes.of(Part.EGO)
    assert space.scenario(drawn(space, 1)).ego_vehicles == space.seed.ego_vehicles


def test_the_seeds_route_is_the_first() -> None:
    space = space_around("tee-town", THREE)
    values = with_ego(space, drawn(space, 1), 0, path=0, start=0.0, start_time=0.0)
    assert space.scenario(values).ego_vehicles[0] == space.seed.ego_vehicles[0]


def test_two_are_always_there_and_the_third_may_be_absent() -> None:
    space = space_around("tee-town", THREE)
    blocks = space.genes.of(Part.EGO)
    assert [block.is_optional for block in blocks] == [False, False, True]
    values = drawn(space, 1)
    for present in (0.0, 1.0):
        egos = space.scenario(with_ego(space, values, 2, present=present)).ego_vehicles
        assert [ego.id for ego in egos] == ["ego_0", "ego_1", "ego_2"][: 2 + int(present)]


def test_all_are_driven_and_built_like_the_seeds() -> None:
    seed = seed_scenario("tee-town")
    own = replace(
        seed.ego_vehicles[0],
        agent=AgentChoice(name="idm", parameters={"speed_factor": 0.9}),
        model="vehicle.nissan.micra",
    )
    space = ScenarioSpace(replace(seed, ego_vehicles=(own,)), NETWORKS.get("tee-town"), THREE)
    for ego in space.scenario(drawn(space, 2)).ego_vehicles:
        assert (ego.agent, ego.model, ego.dynamics) == (own.agent, own.model, own.dynamics)


def test_egos_of_the_seed_keep_their_ids() -> None:
    seed = seed_scenario("tee-town")
    first = replace(seed.ego_vehicles[0], id="mine")
    other = replace(seed_scenario("tee-town", 1).ego_vehicles[0], id="ego_2")
    both = replace(seed, ego_vehicles=(first, other))
    space = ScenarioSpace(both, NETWORKS.get("tee-town"), THREE)
    values = with_ego(space, drawn(space, 1), 2, present=1.0)
    ids = [ego.id for ego in space.scenario(values).ego_vehicles]
    # The third would be ego_2, which is taken.
    assert ids == ["mine", "ego_2", "ego_2.1"]
    # The actors of a violation can be found among the genes.
    assert [block.actor for block in space.genes.of(Part.EGO)] == ids


@settings(max_examples=25)
@given(number=st.integers(0, 2**32 - 1), town=st.sampled_from(SHIPPED))
def test_an_ego_follows_the_route_that_it_chose(number: int, town: str) -> None:
    space = space_around(town, THREE)
    values = drawn(space, number)
    for ego in space.scenario(values).ego_vehicles:
        route = space.routes[int(values[block_named(space, ego.id).index("path")])]
        planned = plan_route(space.network, route_points(ego.route))
        s, gap = route.path.place_of(ego.route[0].x, ego.route[0].y)
        assert gap < 1.0
        assert s <= 0.25 * route.path.length + 1.0
        assert planned.length == pytest.approx(route.path.length - s, abs=1.5)
        assert 0.0 <= ego.start_time <= 15.0


@pytest.mark.parametrize("town", SHIPPED)
def test_routes_are_about_as_long_as_the_seeds(town: str) -> None:
    space = space_around(town, THREE)
    own = space.routes[0].path.length
    assert 2 <= len(space.routes) <= 12
    for route in space.routes[1:]:
        assert 0.6 * own <= route.path.length <= 1.3 * own


def test_routes_that_meet_are_preferred() -> None:
    conflicts = space_around("signal-grid", THREE).conflicts
    assert conflicts is not None
    assert conflicts[0].sum() >= 4


def test_a_missing_further_route_is_an_error() -> None:
    seed = seed_scenario("tee-town")
    far = MapRegion(
        town="tee-town", region_segment=Region(min_x=-2.0, max_x=-1.0, min_y=-2.0, max_y=-1.0)
    )
    with pytest.raises(SearchError, match=r"no route for a further ego .*use one ego"):
        ScenarioSpace(replace(seed, map_region=far), NETWORKS.get("tee-town"), THREE)
