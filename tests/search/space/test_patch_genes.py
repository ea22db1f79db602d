"""Slippery patches from genes: on an ego's way, valid, and off by default."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.scenario.validation import scenario_problems
from drivora_service.search.genes import Part
from drivora_service.search.space.patch_genes import (
    AHEAD_OF_EGO,
    FRICTIONS,
    LENGTHS,
    MAX_LATERAL,
    WIDTHS,
)
from drivora_service.search.space.source import source_of, space_of
from drivora_service.search.space.space_options import SpaceOptions
from tests.search.space.seeds import NETWORKS, SHIPPED, block_named, drawn, space_around

OPTIONS = SpaceOptions(vehicles=1, walkers=1, obstacles=1, patches=2, weather=False)


@settings(max_examples=40)
@given(
    number=st.integers(0, 2**32 - 1),
    town=st.sampled_from(SHIPPED),
    egos=st.sampled_from([1, 3]),
)
def test_every_patch_is_valid_and_on_the_way_of_its_ego(number: int, town: str, egos: int) -> None:
    options = SpaceOptions(vehicles=0, walkers=0, patches=3, weather=False, egos=egos)
    space = space_around(town, options)
    scenario = space.scenario(drawn(space, number))
    assert len(scenario.friction_patches) == 3
    problems = scenario_problems(scenario, NETWORKS, ("idm",))
    assert not [one for one in problems if one.pointer.startswith("/friction_patches")]
    for patch in scenario.friction_patches:
        place = patch.location
        gaps = [route.path.place_of(place.x, place.y)[1] for route in space.routes]
        assert min(gaps) <= MAX_LATERAL + 0.6
        assert LENGTHS[0] <= patch.length <= LENGTHS[1]
        assert WIDTHS[0] <= patch.width <= WIDTHS[1]
        assert FRICTIONS[0] <= patch.friction <= FRICTIONS[1]


def test_genes_say_where_a_patch_is() -> None:
    space = space_around("tee-town", OPTIONS)
    block, values = block_named(space, "patch_1"), drawn(space, 4)
    route = space.routes[0].path
    for share, lateral in ((0.0, 0.0), (0.5, -1.5), (1.0, 1.0)):
        values[block.index("place")], values[block.index("lateral")] = share, lateral
        values[block.index("friction")] = 0.25
        patch = space.scenario(values).friction_patches[1]
        here = route.at(AHEAD_OF_EGO + share * (route.length - AHEAD_OF_EGO)).beside(lateral)
        assert (patch.location.x, patch.location.y) == pytest.approx((here.x, here.y), abs=0.01)
        assert math.cos((patch.location.yaw or 0.0) - here.yaw) == pytest.approx(1.0, abs=1e-6)
        assert (patch.id, patch.friction) == ("patch_1", 0.25)


def test_optional_patches_may_be_absent() -> None:
    space = space_around("tee-town", SpaceOptions(patches=2, optional=True))
    values = drawn(space, 1)
    for present in (0.0, 1.0):
        for block in space.genes.of(Part.PATCH):
            values[block.index("present")] = present
        assert len(space.scenario(values).friction_patches) == 2 * present


def test_spaces_without_patches_are_those_from_before_there_were_any() -> None:
    plain = space_around("tee-town", SpaceOptions())
    assert not plain.genes.of(Part.PATCH)
    source = source_of(plain)
    # As stored campaigns and waiting candidates have it.
    older = source.__class__(seed=source.seed, options=source.options.replace('"patches":0,', ""))
    assert older.options != source.options
    again = space_of(older, NETWORKS)
    assert again.genes.genes == plain.genes.genes
    values = drawn(plain, 8)
    assert again.scenario(values) == plain.scenario(values)


def test_patches_are_behind_the_actors_whose_genes_stay_where_they_were() -> None:
    without = space_around("tee-town", SpaceOptions(vehicles=1, walkers=1, obstacles=1))
    with_patches = space_around(
        "tee-town", SpaceOptions(vehicles=1, walkers=1, obstacles=1, patches=1)
    )
    names = [block.name for block in without.genes.blocks]
    assert [block.name for block in with_patches.genes.blocks] == [
        *names[:3], "patch_0", *names[3:]
    ]  # fmt: skip


@settings(max_examples=20)
@given(number=st.integers(0, 2**32 - 1), town=st.sampled_from(SHIPPED))
def test_the_distance_to_the_ego_is_that_of_the_scenario(number: int, town: str) -> None:
    space = space_around(town, OPTIONS)
    values = drawn(space, number)
    scenario = space.scenario(values)
    start = space.routes[0].path.at(0.0)
    places = {
        **{one.id: one.route[0] for one in scenario.npc_vehicles},
        **{one.id: one.route[0] for one in scenario.npc_walkers},
        **{one.id: one.location for one in scenario.npc_obstacles},
        **{one.id: one.location for one in scenario.friction_patches},
    }
    for block in space.genes.blocks:
        place = places[block.actor]
        distance = space.ego_distance(block, values)
        expected = math.hypot(place.x - start.x, place.y - start.y)
        assert distance == pytest.approx(expected, abs=0.01)


def test_weather_and_lights_have_no_distance() -> None:
    space = space_around("signal-grid", SpaceOptions(lights=True, egos=2))
    values = drawn(space, 2)
    for block in space.genes.blocks:
        known = space.ego_distance(block, values) is not None
        assert known is (block.part in (Part.VEHICLE, Part.WALKER))
